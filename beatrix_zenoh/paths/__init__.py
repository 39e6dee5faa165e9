"""Paths of the arms over time, and choreographies: checked against the limits, planned as targets, and followed."""
