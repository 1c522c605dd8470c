"""The service under work: speed, size, many robots, years, kills, backups, the first thing that people run."""
