-- How the sensors of each robot scatter from visit to visit by its own visits, as its newest revision that was judged has it: what
-- other robots of its rig model with the same reference are held against. Follows from the rest, and is replaced with every such
-- revision.

CREATE TABLE summary_scatter (
  rig_model TEXT NOT NULL CHECK (rig_model <> ''),
  reference_id TEXT NOT NULL,
  robot_id TEXT NOT NULL REFERENCES robot,
  sensor_id TEXT NOT NULL,
  translation_between_m2 REAL NOT NULL,      -- variance per axis beyond what the visits err by; may be below zero
  translation_own_m2 REAL NOT NULL,          -- what the visits themselves err by
  translation_dof REAL NOT NULL CHECK (translation_dof > 0),  -- behind the sum of both
  rotation_between_rad2 REAL NOT NULL,
  rotation_own_rad2 REAL NOT NULL,
  rotation_dof REAL NOT NULL CHECK (rotation_dof > 0),
  PRIMARY KEY (rig_model, reference_id, robot_id, sensor_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX summary_scatter_of_robot ON summary_scatter (robot_id);
