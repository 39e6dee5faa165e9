"""`beatrix lesson`: lessons as folders, and checks that observe what a program does with a robot."""
