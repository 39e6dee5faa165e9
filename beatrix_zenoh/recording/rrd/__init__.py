"""Rerun: nothing else imports it. Streams, layout, and reading files back."""

from __future__ import annotations

import os

# Rerun reads this when it is imported. BEATRIX reports errors itself.
os.environ.setdefault("RUST_LOG", "off")
