"""Run the command line: `python -m beatrix_zenoh.cli` is the same as `beatrix`."""

from __future__ import annotations

from beatrix_zenoh.cli.app import main

main()
