-- Finished edges say when they were measured.

ALTER TABLE edge ADD COLUMN measured_ns INTEGER;  -- as it was told; NULL: when its session was captured, or it was stored
