"""The tools round the service: simulation, import and record, check, companion, clouds, formats of others."""
