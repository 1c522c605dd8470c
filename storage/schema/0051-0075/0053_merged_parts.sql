-- Pushed edges of one pair that contradict each other, as a sensor was moved, are several merged edges: the first stands in merged_edge.

ALTER TABLE merged_edge ADD COLUMN visits BLOB;  -- of its score: by what edges scatter from visit to visit; NULL: they do not

CREATE TABLE merged_edge_apart (             -- that a revision counts, beside the one in merged_edge
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  part INTEGER NOT NULL CHECK (part > 0),
  edges INTEGER NOT NULL CHECK (edges > 0),  -- and so on, as there
  newest_ns INTEGER NOT NULL,
  T_a_b_x_m REAL NOT NULL,
  T_a_b_y_m REAL NOT NULL,
  T_a_b_z_m REAL NOT NULL,
  T_a_b_qx REAL NOT NULL,
  T_a_b_qy REAL NOT NULL,
  T_a_b_qz REAL NOT NULL,
  T_a_b_qw REAL NOT NULL,
  source TEXT NOT NULL,
  dof INTEGER NOT NULL,
  by_blocks INTEGER NOT NULL CHECK (by_blocks IN (0, 1)),
  information BLOB NOT NULL,
  scatter BLOB NOT NULL,
  given BLOB NOT NULL,
  visits BLOB,
  PRIMARY KEY (robot_id, revision_number, frame_a, frame_b, method, part),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;
CREATE TRIGGER merged_edge_apart_no_update BEFORE UPDATE ON merged_edge_apart BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_apart_no_delete BEFORE DELETE ON merged_edge_apart BEGIN SELECT RAISE(ABORT, 'append-only'); END;

CREATE TABLE merged_edge_apart_constant (
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  part INTEGER NOT NULL CHECK (part > 0),
  name TEXT NOT NULL,
  scores BLOB NOT NULL,                      -- six numbers per constant
  PRIMARY KEY (robot_id, revision_number, frame_a, frame_b, method, part, name),
  FOREIGN KEY (robot_id, revision_number, frame_a, frame_b, method, part) REFERENCES merged_edge_apart
) STRICT, WITHOUT ROWID;
CREATE TRIGGER merged_edge_apart_constant_no_update BEFORE UPDATE ON merged_edge_apart_constant BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_apart_constant_no_delete BEFORE DELETE ON merged_edge_apart_constant BEGIN SELECT RAISE(ABORT, 'append-only'); END;
