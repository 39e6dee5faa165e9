"""Generated from schemas/*.toml by schemas/generate.py."""
