"""The hardware node: a robot's board on a serial port, or the firmware on a virtual one."""
