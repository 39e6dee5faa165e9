"""`tools/zenoh_examples.py` drives both robots with Zenoh's example programs.

ZENOH_EXAMPLES names a folder with the unmodified programs of zenoh-python; without it, programs with the same options
take their place.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import zenoh_programs
from robots import Process


@pytest.mark.long("a dozen programs, one after the other")
def test_both_robots_are_read_driven_and_stopped_by_zenohs_programs(tmp_path: Path) -> None:
    folder = os.environ.get("ZENOH_EXAMPLES", "")
    if not folder:
        zenoh_programs.write(tmp_path)
    tool = Process("tools/zenoh_examples.py", folder or str(tmp_path), traced=False)
    assert tool.wait(120.0) == 0, tool.lines
    assert tool.lines[-1] == "both robots were read, controlled and stopped"
