-- Edges of sessions are merged too, whole sessions at a time, and what a visit costs is kept from growing with the sessions
-- before: which of them repeat each other, which sensors they list, which they name as remounted is said once, as they come.

ALTER TABLE merged_edge RENAME TO merged_edge_14;
ALTER TABLE merged_edge_constant RENAME TO merged_edge_constant_14;

CREATE TABLE merged_edge (                   -- that a revision counts
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  of_sessions INTEGER NOT NULL CHECK (of_sessions IN (0, 1)),  -- or of edges that were pushed as finished results
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
  PRIMARY KEY (robot_id, revision_number, frame_a, frame_b, method, of_sessions),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TABLE merged_edge_constant (          -- given constants that edges have in common
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  of_sessions INTEGER NOT NULL CHECK (of_sessions IN (0, 1)),  -- or of edges that were pushed as finished results
  name TEXT NOT NULL,
  scores BLOB NOT NULL,                      -- six numbers per constant
  PRIMARY KEY (robot_id, revision_number, frame_a, frame_b, method, of_sessions, name),
  FOREIGN KEY (robot_id, revision_number, frame_a, frame_b, method, of_sessions) REFERENCES merged_edge
) STRICT, WITHOUT ROWID;

INSERT INTO merged_edge
  SELECT robot_id, revision_number, frame_a, frame_b, method, 0, edges, newest_ns, T_a_b_x_m, T_a_b_y_m, T_a_b_z_m, T_a_b_qx, T_a_b_qy,
         T_a_b_qz, T_a_b_qw, source, dof, by_blocks, information, scatter, given FROM merged_edge_14;
INSERT INTO merged_edge_constant
  SELECT robot_id, revision_number, frame_a, frame_b, method, 0, name, scores FROM merged_edge_constant_14;
DROP TABLE merged_edge_constant_14;
DROP TABLE merged_edge_14;

CREATE TABLE merge_state_scores (            -- of the robot's newest revision only: what the next one extends
  robot_id TEXT NOT NULL REFERENCES robot,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  scores BLOB NOT NULL,                      -- six numbers per column; the columns are alike in all rows of a robot
  PRIMARY KEY (robot_id, frame_a, frame_b, method)
) STRICT, WITHOUT ROWID;

CREATE TABLE merge_basis (                   -- what people said of edges that are in no window, as of a revision
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  digest TEXT NOT NULL,
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TABLE session_repeat (                -- sessions of one robot: the later one holds half or more of what the earlier holds
  robot_id TEXT NOT NULL REFERENCES robot,
  earlier_number INTEGER NOT NULL REFERENCES session,
  later_number INTEGER NOT NULL REFERENCES session,
  PRIMARY KEY (robot_id, earlier_number, later_number)
) STRICT, WITHOUT ROWID;

INSERT INTO session_repeat
  SELECT old.robot_id, old.number, later.number FROM session old JOIN payload ON payload.session_number = old.number
  JOIN payload again ON again.digest = payload.digest AND again.session_number > old.number
  JOIN session later ON later.number = again.session_number AND later.robot_id = old.robot_id
  GROUP BY old.number, later.number HAVING 2 * count(DISTINCT payload.idx) >= old.payload_count;

CREATE TABLE listed_sensor (                 -- by any closed session
  robot_id TEXT NOT NULL REFERENCES robot,
  sensor_id TEXT NOT NULL,
  PRIMARY KEY (robot_id, sensor_id)
) STRICT, WITHOUT ROWID;

INSERT INTO listed_sensor
  SELECT DISTINCT session.robot_id, json_extract(sensor.value, '$.id') FROM session
  JOIN session_closed ON session_closed.session_number = session.number, json_each(session.manifest, '$.sensors') AS sensor;

CREATE TABLE session_remount (               -- of closed sessions
  robot_id TEXT NOT NULL REFERENCES robot,
  session_number INTEGER NOT NULL REFERENCES session,
  sensor_id TEXT NOT NULL,
  PRIMARY KEY (robot_id, session_number, sensor_id)
) STRICT, WITHOUT ROWID;

INSERT INTO session_remount
  SELECT DISTINCT session.robot_id, session.number, sensor.value FROM session
  JOIN session_closed ON session_closed.session_number = session.number,
  json_each(CASE WHEN instr(session.manifest, '"remounted"') > 0 THEN session.manifest ELSE '{}' END, '$.remounted') AS sensor;

CREATE TRIGGER merged_edge_no_update BEFORE UPDATE ON merged_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_no_delete BEFORE DELETE ON merged_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_constant_no_update BEFORE UPDATE ON merged_edge_constant BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_constant_no_delete BEFORE DELETE ON merged_edge_constant BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merge_basis_no_update BEFORE UPDATE ON merge_basis BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merge_basis_no_delete BEFORE DELETE ON merge_basis BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_repeat_no_update BEFORE UPDATE ON session_repeat BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_repeat_no_delete BEFORE DELETE ON session_repeat BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER listed_sensor_no_update BEFORE UPDATE ON listed_sensor BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER listed_sensor_no_delete BEFORE DELETE ON listed_sensor BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_remount_no_update BEFORE UPDATE ON session_remount BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_remount_no_delete BEFORE DELETE ON session_remount BEGIN SELECT RAISE(ABORT, 'append-only'); END;
