"""Kinematics, gear, trajectories and limits of the neck: calculation only."""
