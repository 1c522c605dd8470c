-- Stored sessions that are computed again with the software of today: what was asked for, what of it is still to be done,
-- and what came of it. Nothing that was measured, approved or in use is changed by it.

CREATE TABLE recomputation (                 -- a run
  number INTEGER PRIMARY KEY,
  digest TEXT NOT NULL CHECK (length(digest) = 64),  -- of software, scope and sessions: the same again is the same run
  scope TEXT NOT NULL CHECK (scope IN ('all', 'model', 'robot', 'board')),
  subject TEXT NOT NULL,                     -- rig model, robot or serial; of all empty
  asked_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  software TEXT NOT NULL,                    -- version of rigcal
  estimator TEXT NOT NULL                    -- of session estimates, with its version
) STRICT;
CREATE INDEX recomputation_same ON recomputation (digest, number);

CREATE TABLE recomputation_robot (
  number INTEGER PRIMARY KEY,                -- in this order
  run_number INTEGER NOT NULL REFERENCES recomputation,
  robot_id TEXT NOT NULL REFERENCES robot,
  UNIQUE (run_number, robot_id)
) STRICT;

CREATE TABLE recomputation_session (
  number INTEGER PRIMARY KEY,
  robot_number INTEGER NOT NULL REFERENCES recomputation_robot,
  session_number INTEGER NOT NULL REFERENCES session,
  sizes TEXT NOT NULL                        -- canonical JSON of measured square sizes; empty: those of the session
) STRICT;
CREATE INDEX recomputation_session_of ON recomputation_session (session_number, number);
CREATE INDEX recomputation_session_in ON recomputation_session (robot_number, number);

CREATE TABLE waiting_recomputed_session (
  robot_number INTEGER NOT NULL REFERENCES recomputation_robot,
  item_number INTEGER NOT NULL REFERENCES recomputation_session,
  PRIMARY KEY (robot_number, item_number)
) STRICT, WITHOUT ROWID;

CREATE TABLE waiting_recomputed_robot (
  robot_number INTEGER PRIMARY KEY REFERENCES recomputation_robot
) STRICT;

CREATE TABLE recomputed_session (
  item_number INTEGER PRIMARY KEY REFERENCES recomputation_session,
  ended_ns INTEGER NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('computed', 'same', 'kept', 'failed')),
  kept_estimator TEXT,                       -- of a kept one: which of its estimates counts; NULL: there is none
  why TEXT NOT NULL                          -- of a kept or failed one; else empty
) STRICT;

CREATE TABLE recomputed_robot (
  robot_number INTEGER PRIMARY KEY REFERENCES recomputation_robot,
  robot_id TEXT NOT NULL REFERENCES robot,
  ended_ns INTEGER NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('changed', 'unchanged', 'failed')),
  revision_number INTEGER,                   -- of a changed one: the candidate
  against_number INTEGER,                    -- what it is compared with: in use then, else the newest; NULL: none
  edge_watermark INTEGER NOT NULL,           -- number of the robot's newest edge that it counts
  why TEXT NOT NULL,                         -- of a failed one; else empty
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision (robot_id, number)
) STRICT;
CREATE INDEX recomputed_robot_of ON recomputed_robot (robot_id, revision_number);

CREATE TABLE recomputed_change (             -- a sensor that would sit elsewhere
  robot_number INTEGER NOT NULL REFERENCES recomputation_robot,
  sensor TEXT NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('moved', 'gained', 'lost')),
  moved_m REAL, turned_rad REAL,             -- NULL: one of the two poses is not known
  sigma_ratio REAL,                          -- in sigmas of what it is compared with, the worst axis; NULL: not known
  PRIMARY KEY (robot_number, sensor)
) STRICT, WITHOUT ROWID;

CREATE TRIGGER recomputation_no_update BEFORE UPDATE ON recomputation BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputation_no_delete BEFORE DELETE ON recomputation BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputation_robot_no_update BEFORE UPDATE ON recomputation_robot BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputation_robot_no_delete BEFORE DELETE ON recomputation_robot BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputation_session_no_update BEFORE UPDATE ON recomputation_session BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputation_session_no_delete BEFORE DELETE ON recomputation_session BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputed_session_no_update BEFORE UPDATE ON recomputed_session BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputed_session_no_delete BEFORE DELETE ON recomputed_session BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputed_robot_no_update BEFORE UPDATE ON recomputed_robot BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputed_robot_no_delete BEFORE DELETE ON recomputed_robot BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputed_change_no_update BEFORE UPDATE ON recomputed_change BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER recomputed_change_no_delete BEFORE DELETE ON recomputed_change BEGIN SELECT RAISE(ABORT, 'append-only'); END;
