"""What the neck may do: every motion is checked over its whole way before it is accepted."""

from __future__ import annotations

from beatrix_zenoh.limits.check import Limits
from beatrix_zenoh.limits.walk import BEYOND, looked_at

__all__ = ["BEYOND", "Limits", "looked_at"]
