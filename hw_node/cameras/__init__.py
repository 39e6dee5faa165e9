"""The cameras of a robot: USB cameras, files and test pictures."""
