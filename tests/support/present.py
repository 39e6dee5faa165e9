"""Values that may be missing, for example refusals and banners of a view: `present(view.banner).text`."""

from __future__ import annotations

from typing import TypeVar

Value = TypeVar("Value")


def present(value: Value | None) -> Value:
    """Return a value; fail if it is None."""
    assert value is not None
    return value
