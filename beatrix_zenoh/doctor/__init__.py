"""`beatrix doctor`: its checks, and the question which motor turns."""
