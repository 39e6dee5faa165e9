"""Widgets: each shows one view and emits intents."""
