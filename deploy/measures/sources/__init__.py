"""The code base itself, read from its sources."""
