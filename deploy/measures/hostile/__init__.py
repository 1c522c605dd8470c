"""Input that is wrong, or wants to be."""
