"""`beatrix demo`."""
