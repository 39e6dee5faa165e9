"""Streams, layout and files of Rerun; no other package imports `rerun`."""

from __future__ import annotations

import os

# Rerun reads this variable when it is imported. BEATRIX reports errors itself, so Rerun need not log them.
os.environ.setdefault("RUST_LOG", "off")
