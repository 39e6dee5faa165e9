"""`python -m beatrix_zenoh.cli` is `beatrix`."""

from __future__ import annotations

from beatrix_zenoh.cli.app import main

main()
