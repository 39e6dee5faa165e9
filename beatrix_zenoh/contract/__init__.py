"""What all programs share: messages, keys, codec, names, errors, and refusals with their sentences."""

from __future__ import annotations
