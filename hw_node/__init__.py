"""The hardware node: a robot's board on a serial port, or a virtual board."""
