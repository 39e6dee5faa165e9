"""Kinematics, gear, trajectories and limits of the neck: calculations without I/O."""
