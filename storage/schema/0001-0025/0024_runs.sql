-- What robots say that they run.

CREATE TABLE robot_runs (                    -- of each robot the newest holds; another row only where it runs something else
  number INTEGER PRIMARY KEY,
  robot_id TEXT NOT NULL REFERENCES robot,
  digest TEXT NOT NULL CHECK (length(digest) = 64),
  revision_number INTEGER NOT NULL,          -- with that digest, when it was told; 0: none
  applied_ns INTEGER NOT NULL,               -- by the robot's clock
  told_ns INTEGER NOT NULL,
  who TEXT NOT NULL                          -- the program that applied it
) STRICT;
CREATE INDEX robot_runs_of_robot ON robot_runs (robot_id, number);

ALTER TABLE summary_robot ADD COLUMN runs_revision INTEGER;            -- NULL: it never told; 0: none that is known
ALTER TABLE summary_robot ADD COLUMN runs_trouble TEXT NOT NULL DEFAULT '';

CREATE TRIGGER robot_runs_changes AFTER INSERT ON robot_runs
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;
CREATE TRIGGER robot_runs_no_update BEFORE UPDATE ON robot_runs BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER robot_runs_no_delete BEFORE DELETE ON robot_runs BEGIN SELECT RAISE(ABORT, 'append-only'); END;
