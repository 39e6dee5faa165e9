"""The robot's body in pictures: one shape, made from the robot's values, and the rotations of its parts."""
