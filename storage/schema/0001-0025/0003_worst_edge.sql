-- The edge of each revision that fits worst, for lists of many robots. Revisions made before have none.

CREATE TABLE revision_worst_edge (
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  residual_ratio REAL NOT NULL CHECK (residual_ratio >= 0),  -- to its own sigma
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TRIGGER revision_worst_edge_no_update BEFORE UPDATE ON revision_worst_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_worst_edge_no_delete BEFORE DELETE ON revision_worst_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
