"""The board behind a node: framing, requests, and the firmware as a virtual board."""

from __future__ import annotations
