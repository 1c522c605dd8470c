-- Everything is append-only but the waiting_* tables: those are queues, and hold only what is still to be done.
-- Times are nanoseconds since 1970-01-01 UTC. Matrices and vectors in BLOBs are little-endian doubles, row by row, in
-- the order [x y z rx ry rz] (m, rad), right tangent. Digests are sha256, 64 lower-case hex digits.

CREATE TABLE robot (
  robot_id TEXT NOT NULL PRIMARY KEY,
  first_seen_ns INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Sessions ------------------------------------------------------------------------------------------------------------

CREATE TABLE session (
  number INTEGER PRIMARY KEY,                -- order of arrival
  session_id TEXT NOT NULL UNIQUE,           -- sha256 of manifest
  robot_id TEXT NOT NULL REFERENCES robot,
  captured_ns INTEGER NOT NULL,
  opened_ns INTEGER NOT NULL,
  operator_name TEXT NOT NULL,
  payload_count INTEGER NOT NULL CHECK (payload_count >= 0),
  size_bytes INTEGER NOT NULL CHECK (size_bytes >= 0),
  manifest TEXT NOT NULL                     -- canonical JSON; last, so that lists need not read past it
) STRICT;
CREATE INDEX session_of_robot ON session (robot_id, captured_ns);

CREATE TABLE session_closed (
  session_number INTEGER PRIMARY KEY REFERENCES session,
  closed_ns INTEGER NOT NULL
) STRICT;

CREATE TABLE payload (
  session_number INTEGER NOT NULL REFERENCES session,
  idx INTEGER NOT NULL CHECK (idx >= 0),     -- position in the manifest
  path TEXT NOT NULL,
  digest TEXT NOT NULL CHECK (length(digest) = 64),
  size_bytes INTEGER NOT NULL CHECK (size_bytes >= 0),
  PRIMARY KEY (session_number, idx)
) STRICT, WITHOUT ROWID;

CREATE INDEX payload_of_digest ON payload (digest);

CREATE TABLE payload_held (
  session_number INTEGER NOT NULL,
  idx INTEGER NOT NULL,
  held_ns INTEGER NOT NULL,
  PRIMARY KEY (session_number, idx),
  FOREIGN KEY (session_number, idx) REFERENCES payload
) STRICT, WITHOUT ROWID;

CREATE TABLE digest_held (                   -- by any session
  digest TEXT NOT NULL PRIMARY KEY,
  held_ns INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TRIGGER payload_of_closed_session BEFORE INSERT ON payload
WHEN EXISTS (SELECT 1 FROM session_closed WHERE session_number = new.session_number)
BEGIN SELECT RAISE(ABORT, 'a closed session takes no more payloads'); END;

-- Jobs ----------------------------------------------------------------------------------------------------------------

CREATE TABLE job (
  number INTEGER PRIMARY KEY,                -- oldest first
  session_number INTEGER NOT NULL REFERENCES session,
  sensor_a TEXT NOT NULL,
  sensor_b TEXT NOT NULL,
  queued_ns INTEGER NOT NULL,
  UNIQUE (session_number, sensor_a, sensor_b)
) STRICT;

CREATE TABLE job_finished (
  job_number INTEGER PRIMARY KEY REFERENCES job,
  finished_ns INTEGER NOT NULL
) STRICT;

CREATE TABLE waiting_job (
  job_number INTEGER PRIMARY KEY REFERENCES job,
  robot_id TEXT NOT NULL
) STRICT;
CREATE INDEX waiting_job_of_robot ON waiting_job (robot_id);

-- Edges ---------------------------------------------------------------------------------------------------------------

CREATE TABLE edge (
  number INTEGER PRIMARY KEY,                -- order of arrival: the watermark of revisions
  edge_id TEXT NOT NULL UNIQUE CHECK (length(edge_id) = 64),
  robot_id TEXT NOT NULL REFERENCES robot,
  session_id TEXT REFERENCES session (session_id),  -- NULL: pushed as a finished edge
  epoch INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('good', 'failed')),
  appended_ns INTEGER NOT NULL,
  -- p_a = T_a_b * p_b, quaternion Hamilton. From here on NULL in a failed edge.
  T_a_b_x_m REAL,
  T_a_b_y_m REAL,
  T_a_b_z_m REAL,
  T_a_b_qx REAL,
  T_a_b_qy REAL,
  T_a_b_qz REAL,
  T_a_b_qw REAL,
  information BLOB CHECK (length(information) = 288),
  rank INTEGER CHECK (rank BETWEEN 0 AND 6),
  dof INTEGER CHECK (dof >= 0),              -- 0: known exactly
  source TEXT CHECK (source IN ('jackknife', 'model', 'given', 'assumed')),
  covariance BLOB CHECK (length(covariance) = 288),  -- on the observable subspace; derived from information
  unobservable_basis BLOB CHECK (length(unobservable_basis) = 48 * (6 - rank)),  -- 6 - rank vectors; derived too
  CHECK ((state = 'good') = (T_a_b_x_m + T_a_b_y_m + T_a_b_z_m + T_a_b_qx + T_a_b_qy + T_a_b_qz + T_a_b_qw IS NOT NULL
                             AND information IS NOT NULL AND rank IS NOT NULL AND dof IS NOT NULL
                             AND source IS NOT NULL AND covariance IS NOT NULL AND unobservable_basis IS NOT NULL))
) STRICT;
CREATE INDEX edge_of_robot ON edge (robot_id);
CREATE INDEX edge_of_session ON edge (session_id) WHERE session_id IS NOT NULL;

CREATE TABLE edge_block (                    -- d = Log(T^-1 T_(i)): the answer without block i
  edge_number INTEGER NOT NULL REFERENCES edge,
  idx INTEGER NOT NULL,
  block_id TEXT NOT NULL,
  d_x_m REAL NOT NULL,
  d_y_m REAL NOT NULL,
  d_z_m REAL NOT NULL,
  d_rx_rad REAL NOT NULL,
  d_ry_rad REAL NOT NULL,
  d_rz_rad REAL NOT NULL,
  PRIMARY KEY (edge_number, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE edge_contribution (             -- what a given constant brings; already inside information
  edge_number INTEGER NOT NULL REFERENCES edge,
  idx INTEGER NOT NULL,
  name TEXT NOT NULL,
  covariance BLOB NOT NULL CHECK (length(covariance) = 288),
  PRIMARY KEY (edge_number, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE edge_diagnosis (
  edge_number INTEGER NOT NULL REFERENCES edge,
  idx INTEGER NOT NULL,
  code TEXT NOT NULL,
  what TEXT NOT NULL,
  cure TEXT NOT NULL,
  PRIMARY KEY (edge_number, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE edge_figure (                   -- the method's own checks; the unit is the end of the name
  edge_number INTEGER NOT NULL REFERENCES edge,
  name TEXT NOT NULL,
  value REAL NOT NULL,
  PRIMARY KEY (edge_number, name)
) STRICT, WITHOUT ROWID;

CREATE TABLE edge_capture (
  edge_number INTEGER NOT NULL REFERENCES edge,
  idx INTEGER NOT NULL,
  capture_id TEXT NOT NULL,
  rms REAL NOT NULL,                         -- in the unit of the method's residuals
  used INTEGER NOT NULL CHECK (used IN (0, 1)),
  note TEXT NOT NULL,                        -- why it was not used
  PRIMARY KEY (edge_number, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE edge_evidence (
  edge_number INTEGER NOT NULL REFERENCES edge,
  idx INTEGER NOT NULL,
  title TEXT NOT NULL,
  sensor_id TEXT NOT NULL,
  capture_id TEXT NOT NULL,
  digest TEXT NOT NULL,
  suffix TEXT NOT NULL,
  PRIMARY KEY (edge_number, idx)
) STRICT, WITHOUT ROWID;

-- Batches of finished edges -------------------------------------------------------------------------------------------

CREATE TABLE batch (
  number INTEGER PRIMARY KEY,
  batch_id TEXT NOT NULL UNIQUE,
  robot_id TEXT NOT NULL REFERENCES robot,
  item_count INTEGER NOT NULL CHECK (item_count >= 0),
  appended_ns INTEGER NOT NULL
) STRICT;

CREATE TABLE batch_item (
  batch_number INTEGER NOT NULL REFERENCES batch,
  idx INTEGER NOT NULL CHECK (idx >= 0),
  edge_number INTEGER NOT NULL REFERENCES edge,
  PRIMARY KEY (batch_number, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE waiting_batch (                 -- incomplete
  batch_number INTEGER PRIMARY KEY REFERENCES batch,
  robot_id TEXT NOT NULL,
  missing_count INTEGER NOT NULL CHECK (missing_count > 0),
  newest_ns INTEGER NOT NULL
) STRICT;
CREATE INDEX waiting_batch_of_robot ON waiting_batch (robot_id, newest_ns);

-- Revisions -----------------------------------------------------------------------------------------------------------

CREATE TABLE revision (
  robot_id TEXT NOT NULL REFERENCES robot,
  number INTEGER NOT NULL CHECK (number >= 1),
  created_ns INTEGER NOT NULL,
  edge_watermark INTEGER NOT NULL,           -- number of the newest edge that it contains
  verdict TEXT NOT NULL CHECK (verdict IN ('pass', 'warn', 'fail', 'unknown')),
  verdict_why TEXT NOT NULL,
  verdict_what_to_do TEXT NOT NULL,
  digest TEXT NOT NULL,                      -- of document
  document TEXT NOT NULL,                    -- canonical JSON; last, so that lists need not read past it
  PRIMARY KEY (robot_id, number)
) STRICT;

CREATE TABLE publication (
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  published_ns INTEGER NOT NULL,
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TABLE waiting_publication (
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

-- Detections and audit ------------------------------------------------------------------------------------------------

CREATE TABLE detected_view (                 -- what a detector finds in a picture, by content
  image_digest TEXT NOT NULL,
  detector TEXT NOT NULL,                    -- algorithm, version, target geometry
  found INTEGER NOT NULL CHECK (found IN (0, 1)),
  why_not TEXT NOT NULL,
  target_id TEXT NOT NULL,
  width_px INTEGER NOT NULL,
  height_px INTEGER NOT NULL,
  corners_px BLOB NOT NULL CHECK (length(corners_px) % 16 = 0),  -- x, y, x, y, ...
  picture_digest TEXT,                       -- annotated picture; NULL: none
  PRIMARY KEY (image_digest, detector)
) STRICT, WITHOUT ROWID;

CREATE TABLE audit (
  number INTEGER PRIMARY KEY,
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  what TEXT NOT NULL
) STRICT;

-- Append-only ---------------------------------------------------------------------------------------------------------

CREATE TRIGGER robot_no_update BEFORE UPDATE ON robot BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER robot_no_delete BEFORE DELETE ON robot BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_no_update BEFORE UPDATE ON session BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_no_delete BEFORE DELETE ON session BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_closed_no_update BEFORE UPDATE ON session_closed BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_closed_no_delete BEFORE DELETE ON session_closed BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER payload_no_update BEFORE UPDATE ON payload BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER payload_no_delete BEFORE DELETE ON payload BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER payload_held_no_update BEFORE UPDATE ON payload_held BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER payload_held_no_delete BEFORE DELETE ON payload_held BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER digest_held_no_update BEFORE UPDATE ON digest_held BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER digest_held_no_delete BEFORE DELETE ON digest_held BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER job_no_update BEFORE UPDATE ON job BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER job_no_delete BEFORE DELETE ON job BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER job_finished_no_update BEFORE UPDATE ON job_finished BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER job_finished_no_delete BEFORE DELETE ON job_finished BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_no_update BEFORE UPDATE ON edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_no_delete BEFORE DELETE ON edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_block_no_update BEFORE UPDATE ON edge_block BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_block_no_delete BEFORE DELETE ON edge_block BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_contribution_no_update
  BEFORE UPDATE ON edge_contribution BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_contribution_no_delete
  BEFORE DELETE ON edge_contribution BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_diagnosis_no_update BEFORE UPDATE ON edge_diagnosis BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_diagnosis_no_delete BEFORE DELETE ON edge_diagnosis BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_figure_no_update BEFORE UPDATE ON edge_figure BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_figure_no_delete BEFORE DELETE ON edge_figure BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_capture_no_update BEFORE UPDATE ON edge_capture BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_capture_no_delete BEFORE DELETE ON edge_capture BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_evidence_no_update BEFORE UPDATE ON edge_evidence BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_evidence_no_delete BEFORE DELETE ON edge_evidence BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER batch_no_update BEFORE UPDATE ON batch BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER batch_no_delete BEFORE DELETE ON batch BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER batch_item_no_update BEFORE UPDATE ON batch_item BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER batch_item_no_delete BEFORE DELETE ON batch_item BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_no_update BEFORE UPDATE ON revision BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_no_delete BEFORE DELETE ON revision BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER publication_no_update BEFORE UPDATE ON publication BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER publication_no_delete BEFORE DELETE ON publication BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER detected_view_no_update BEFORE UPDATE ON detected_view BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER detected_view_no_delete BEFORE DELETE ON detected_view BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER audit_no_update BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER audit_no_delete BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'append-only'); END;
