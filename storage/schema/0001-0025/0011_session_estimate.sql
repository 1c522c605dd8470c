-- What one joint refinement of a session's raw observations gave.

CREATE TABLE session_estimate (
  session_number INTEGER NOT NULL REFERENCES session,
  estimator TEXT NOT NULL,                   -- what made it, with its version
  made_ns INTEGER NOT NULL,
  document TEXT NOT NULL,                    -- canonical JSON
  PRIMARY KEY (session_number, estimator)
) STRICT;

CREATE TRIGGER session_estimate_no_update BEFORE UPDATE ON session_estimate BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_estimate_no_delete BEFORE DELETE ON session_estimate BEGIN SELECT RAISE(ABORT, 'append-only'); END;
