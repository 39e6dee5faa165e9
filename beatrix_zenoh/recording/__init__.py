"""Write, read, compare, draw and replay recordings."""
