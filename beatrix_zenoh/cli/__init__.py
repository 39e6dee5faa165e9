"""The command line: `beatrix …`."""
