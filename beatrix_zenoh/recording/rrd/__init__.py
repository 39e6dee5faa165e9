"""Streams, layout and files of Rerun; no other package imports `rerun`."""

from __future__ import annotations

import os

# Rerun reads this variable when it is imported. BEATRIX reports errors itself, so Rerun need not log them.
os.environ.setdefault("RUST_LOG", "off")
# The allocators of Rerun and Arrow keep freed memory for later, which looks like a leak in a recording of hours: with
# these settings, which they read when they are loaded, they return it.
os.environ.setdefault("MIMALLOC_PURGE_DELAY", "0")
os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")
