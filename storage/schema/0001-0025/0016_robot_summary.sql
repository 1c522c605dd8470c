-- What lists of robots show of each, worked out when something of it changed and not for every question; it follows from the
-- other tables, and is replaced. Where what a summary says of the same rows changes, a migration lets all robots wait again.

CREATE TABLE summary_robot (                 -- of one snapshot each
  number INTEGER PRIMARY KEY,
  robot_id TEXT NOT NULL UNIQUE REFERENCES robot,
  changes INTEGER NOT NULL,                  -- of the robot until that snapshot: a summary of fewer is older
  name_key TEXT NOT NULL,                    -- sorts ids as people count: robot-9 before robot-10
  revision_number INTEGER NOT NULL,          -- 0: none yet
  verdict TEXT NOT NULL CHECK (verdict IN ('pass', 'warn', 'fail', 'unknown')),
  calibrated_ns INTEGER,                     -- NULL: it counts nothing
  last_session_ns INTEGER,                   -- when the newest session that came whole was captured; NULL: none did
  worst_ratio REAL,                          -- of the worst edge's residual to its own sigma; NULL: not known
  sessions INTEGER NOT NULL,
  edges INTEGER NOT NULL,                    -- of the revision; without one: all that arrived
  jobs_waiting INTEGER NOT NULL,
  search TEXT NOT NULL,                      -- what is searched for words, in lower case
  calculating INTEGER NOT NULL CHECK (calculating IN (0, 1)),
  usable_number INTEGER,                     -- NULL: no revision may be used
  usable_created_ns INTEGER,
  worst_frame_a TEXT NOT NULL,
  worst_frame_b TEXT NOT NULL,
  verdict_why TEXT NOT NULL,
  verdict_what_to_do TEXT NOT NULL,
  given_up TEXT NOT NULL
) STRICT;

-- What the fleet is counted, filtered and sorted by, without the words.
CREATE INDEX summary_robot_sorted ON summary_robot (name_key, verdict, revision_number, calibrated_ns, last_session_ns,
                                                    worst_ratio, sessions, edges, jobs_waiting);

CREATE TABLE summary_fleet (                 -- how many there are, for pages that ask every second
  only_row INTEGER PRIMARY KEY CHECK (only_row = 1),
  robots INTEGER NOT NULL,
  sessions INTEGER NOT NULL,
  edges INTEGER NOT NULL                     -- that count
) STRICT;

CREATE TABLE waiting_summary (               -- robots of which something changed since their summary was made
  robot_id TEXT NOT NULL PRIMARY KEY REFERENCES robot,
  changes INTEGER NOT NULL                   -- of the robot until now
) STRICT, WITHOUT ROWID;

INSERT INTO summary_fleet
SELECT 1, (SELECT count(*) FROM robot), (SELECT count(*) FROM session), (SELECT count(*) FROM counted_edge);
INSERT INTO waiting_summary SELECT robot_id, 1 FROM robot;

-- Whatever changes something that a summary says is inserted here with its robot.
CREATE VIEW changed_robot AS SELECT robot_id FROM waiting_summary;
CREATE TRIGGER changed_robot_waits INSTEAD OF INSERT ON changed_robot
BEGIN
  INSERT INTO waiting_summary
  SELECT new.robot_id, 1 + coalesce(max(changes), 0) FROM summary_robot WHERE robot_id = new.robot_id
  ON CONFLICT (robot_id) DO UPDATE SET changes = changes + 1;
END;

CREATE TRIGGER robot_changes AFTER INSERT ON robot
BEGIN
  UPDATE summary_fleet SET robots = robots + 1;
  INSERT INTO changed_robot VALUES (new.robot_id);
END;

CREATE TRIGGER session_changes AFTER INSERT ON session
BEGIN
  UPDATE summary_fleet SET sessions = sessions + 1;
  INSERT INTO changed_robot VALUES (new.robot_id);
END;

CREATE TRIGGER session_closed_changes AFTER INSERT ON session_closed
BEGIN INSERT INTO changed_robot SELECT robot_id FROM session WHERE number = new.session_number; END;

CREATE TRIGGER session_estimate_changes AFTER INSERT ON session_estimate
BEGIN INSERT INTO changed_robot SELECT robot_id FROM session WHERE number = new.session_number; END;

CREATE TRIGGER waiting_job_changes AFTER INSERT ON waiting_job
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;
CREATE TRIGGER waiting_job_gone_changes AFTER DELETE ON waiting_job
BEGIN INSERT INTO changed_robot VALUES (old.robot_id); END;

CREATE TRIGGER counted_edge_changes AFTER INSERT ON counted_edge
BEGIN
  UPDATE summary_fleet SET edges = edges + 1;
  INSERT INTO changed_robot VALUES (new.robot_id);
END;

CREATE TRIGGER standing_changes AFTER INSERT ON standing
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;

CREATE TRIGGER revision_changes AFTER INSERT ON revision
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;

CREATE TRIGGER revision_worst_edge_changes AFTER INSERT ON revision_worst_edge
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;

-- An attempt at a revision that did not end with one may be the last.
CREATE TRIGGER attempt_ended_changes AFTER INSERT ON attempt_ended WHEN new.how <> 'done'
BEGIN
  INSERT INTO changed_robot
  SELECT r.robot_id FROM attempt a JOIN robot r ON r.robot_id = substr(a.work, 10, instr(substr(a.work, 10), ' ') - 1)
  WHERE a.number = new.attempt_number AND substr(a.work, 1, 9) = 'revision ';
END;

-- A batch that is not whole is told of a robot that has no revision.
CREATE TRIGGER waiting_batch_changes AFTER INSERT ON waiting_batch
WHEN NOT EXISTS (SELECT 1 FROM revision WHERE robot_id = new.robot_id)
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;
CREATE TRIGGER waiting_batch_fuller_changes AFTER UPDATE ON waiting_batch
WHEN NOT EXISTS (SELECT 1 FROM revision WHERE robot_id = new.robot_id)
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;
CREATE TRIGGER waiting_batch_gone_changes AFTER DELETE ON waiting_batch
WHEN NOT EXISTS (SELECT 1 FROM revision WHERE robot_id = old.robot_id)
BEGIN INSERT INTO changed_robot VALUES (old.robot_id); END;
