-- Of each pair a revision takes the newest edges as they are, and the older ones as one: what a visit costs does not grow with
-- the visits before. Edges stay where they are; this says which ones are in a merged edge, and what that is.

CREATE TABLE merged_edge (                   -- that a revision counts
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  edges INTEGER NOT NULL CHECK (edges > 0),  -- how many are in it
  newest_ns INTEGER NOT NULL,                -- when the newest of them was measured
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
  scatter BLOB NOT NULL,                     -- of its score: by the edges' blocks
  given BLOB NOT NULL,                       -- of its score: by given constants of each edge's own
  PRIMARY KEY (robot_id, revision_number, frame_a, frame_b, method),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TABLE merged_edge_constant (          -- given constants that edges have in common
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  name TEXT NOT NULL,
  scores BLOB NOT NULL,                      -- six numbers per constant
  PRIMARY KEY (robot_id, revision_number, frame_a, frame_b, method, name),
  FOREIGN KEY (robot_id, revision_number, frame_a, frame_b, method) REFERENCES merged_edge
) STRICT, WITHOUT ROWID;

CREATE TABLE waiting_merge (                 -- edges that are in no merged edge
  robot_id TEXT NOT NULL REFERENCES robot,
  edge_number INTEGER NOT NULL REFERENCES edge,
  PRIMARY KEY (robot_id, edge_number)
) STRICT, WITHOUT ROWID;

CREATE TRIGGER counted_edge_unmerged AFTER INSERT ON counted_edge
BEGIN INSERT INTO waiting_merge VALUES (new.robot_id, new.edge_number); END;

INSERT INTO waiting_merge SELECT robot_id, edge_number FROM counted_edge;

CREATE TRIGGER merged_edge_no_update BEFORE UPDATE ON merged_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_no_delete BEFORE DELETE ON merged_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_constant_no_update BEFORE UPDATE ON merged_edge_constant BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_constant_no_delete BEFORE DELETE ON merged_edge_constant BEGIN SELECT RAISE(ABORT, 'append-only'); END;
