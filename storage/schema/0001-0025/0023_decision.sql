-- The life of a calibration: which revisions were approved, rejected, rolled back to; by whom, when, why. What a robot is to use
-- follows from it: the newest revision that was approved or rolled back to, and neither rejected since nor rolled back behind.

CREATE TABLE decision (
  number INTEGER PRIMARY KEY,                -- order of arrival among those of all robots
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('approved', 'rejected', 'rolled_back')),  -- rolled back to this one
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL,                         -- 'policy': by the automatic gate
  reason TEXT NOT NULL,
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT;

-- Until now each revision that passed or warned was announced: that was its approval.
INSERT INTO decision (robot_id, revision_number, how, at_ns, who, reason)
  SELECT robot_id, number, 'approved', created_ns, 'policy', 'announced before approvals were kept' FROM revision
  WHERE verdict IN ('pass', 'warn') ORDER BY robot_id, number;

CREATE INDEX decision_of_robot ON decision (robot_id, number);
CREATE INDEX decision_of_revision ON decision (robot_id, revision_number, number);
CREATE INDEX decision_rolled_back ON decision (robot_id, number) WHERE how = 'rolled_back';

ALTER TABLE summary_robot ADD COLUMN state TEXT NOT NULL DEFAULT '';  -- of its revision
INSERT INTO changed_robot SELECT robot_id FROM robot;

CREATE TRIGGER decision_changes AFTER INSERT ON decision
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;
CREATE TRIGGER decision_no_update BEFORE UPDATE ON decision BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER decision_no_delete BEFORE DELETE ON decision BEGIN SELECT RAISE(ABORT, 'append-only'); END;
