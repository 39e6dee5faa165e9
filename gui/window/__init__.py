"""The window: Qt widgets that draw the console's views and report intents."""

from __future__ import annotations
