"""The microphones of a robot: a sound device, a file, or a test tone."""
