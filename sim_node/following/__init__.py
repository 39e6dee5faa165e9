"""The simulation follows the hardware: set points received over the network become motions of its own firmware."""
