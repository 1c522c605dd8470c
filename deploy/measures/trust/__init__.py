"""Whether what is claimed holds: sigmas against truth, sessions that break what is taken for granted, verdicts."""
