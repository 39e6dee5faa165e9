"""The control page for browsers: Chromebooks, tablets, telephones."""

from __future__ import annotations
