-- What failed pairs have in common, by keys (server/model/cause.h) that are the same on all robots: lists of work count by them.

CREATE TABLE revision_cause (                -- of revisions made before there are none
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  cause_key TEXT NOT NULL,
  PRIMARY KEY (robot_id, revision_number, cause_key),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TRIGGER revision_cause_no_update BEFORE UPDATE ON revision_cause BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_cause_no_delete BEFORE DELETE ON revision_cause BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_cause_changes AFTER INSERT ON revision_cause
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;

ALTER TABLE summary_robot ADD COLUMN causes TEXT NOT NULL DEFAULT '[]';  -- keys of the revision's causes, as a JSON list

CREATE TABLE summary_cause (                 -- the same, a row for each
  cause_key TEXT NOT NULL,
  robot_number INTEGER NOT NULL,             -- of summary_robot
  PRIMARY KEY (cause_key, robot_number)
) STRICT, WITHOUT ROWID;

CREATE TABLE summary_cause_count (           -- how many robots have it
  cause_key TEXT NOT NULL PRIMARY KEY,
  robots INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX summary_cause_count_most ON summary_cause_count (robots DESC, cause_key);

CREATE TRIGGER summary_robot_has_causes AFTER INSERT ON summary_robot
BEGIN INSERT INTO summary_cause SELECT value, new.number FROM json_each(new.causes); END;
CREATE TRIGGER summary_robot_had_causes AFTER DELETE ON summary_robot
BEGIN
  DELETE FROM summary_cause WHERE robot_number = old.number AND cause_key IN (SELECT value FROM json_each(old.causes));
END;

CREATE TRIGGER summary_cause_counts AFTER INSERT ON summary_cause
BEGIN
  INSERT INTO summary_cause_count VALUES (new.cause_key, 1) ON CONFLICT (cause_key) DO UPDATE SET robots = robots + 1;
END;
CREATE TRIGGER summary_cause_counts_no_more AFTER DELETE ON summary_cause
BEGIN
  UPDATE summary_cause_count SET robots = robots - 1 WHERE cause_key = old.cause_key;
  DELETE FROM summary_cause_count WHERE cause_key = old.cause_key AND robots = 0;
END;

-- More of a robot's row is searched: all are worked out again.
INSERT INTO changed_robot SELECT robot_id FROM robot;
