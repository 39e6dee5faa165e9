"""Streams, layout and files of Rerun; no other package imports it."""

from __future__ import annotations

import os

# Rerun reads this when it is imported. BEATRIX reports errors itself.
os.environ.setdefault("RUST_LOG", "off")
