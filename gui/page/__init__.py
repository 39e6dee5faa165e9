"""The control page for browsers: Chromebooks, tablets, phones."""

from __future__ import annotations
