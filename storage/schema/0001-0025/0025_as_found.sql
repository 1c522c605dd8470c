-- What the newest session of a revision found of the calibration that was in use before it.

CREATE TABLE revision_as_found (             -- of revisions with sessions, but those that waited for pairs
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  session_id TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('unchanged', 'drifted', 'not_measured')),
  drifted TEXT NOT NULL,                     -- sensors, with '/' between: it is in no id
  zstd BLOB NOT NULL,                        -- one frame: all of it, as JSON
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT;

CREATE TRIGGER revision_as_found_no_update BEFORE UPDATE ON revision_as_found BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_as_found_no_delete BEFORE DELETE ON revision_as_found BEGIN SELECT RAISE(ABORT, 'append-only'); END;
