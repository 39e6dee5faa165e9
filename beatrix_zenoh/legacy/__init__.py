"""The pseudo-terminal of programs of 2023."""

from __future__ import annotations

import sys

if sys.platform == "win32":
    from beatrix_zenoh.legacy.no_terminal import Terminal as Terminal
else:
    from beatrix_zenoh.legacy.terminal import Terminal as Terminal
