"""The pseudo-terminal of programs of 2023."""

from __future__ import annotations

from beatrix_zenoh.legacy.terminal import Terminal as Terminal
