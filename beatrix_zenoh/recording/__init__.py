"""Recordings: written, read, compared, drawn, and played again."""
