"""Decoding a request takes little time, whatever its content."""

from __future__ import annotations

import time

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh.bus import query_forms
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract._generated.messages import MotionQuery


@pytest.mark.parametrize(
    "raw",
    [
        RawQuery(b"0 0 " + b"1" * 3000 + b"x", "", ""),
        RawQuery(b"", "", f"x={'1' * 3000}x;y=0;z=0"),
        RawQuery(b"0 0 " + b"1" * 100_000 + b"x", "", ""),
        RawQuery(b"", "", f"x={'1' * 100_000};y=0;z=0"),
        RawQuery(b"[" * 100_000, "", ""),
    ],
    ids=["words", "parameters", "long words", "long parameters", "brackets"],
)
def test_a_long_request_is_refused_within_50_ms(raw: RawQuery) -> None:
    """Decoding holds the interpreter lock, which delays STOP and positions."""
    began_s = time.process_time()
    with pytest.raises(Refused):
        query_forms.read(raw, MotionQuery)
    assert time.process_time() - began_s < 0.05
