-- What was known of the robot when somebody decided: what the policy may put in use after a rejection or a rollback
-- depends on whether anything was measured since.

ALTER TABLE decision ADD COLUMN edge_watermark INTEGER NOT NULL DEFAULT 0;  -- number of the robot's newest edge then

DROP TRIGGER decision_no_update;
UPDATE decision SET edge_watermark = coalesce(
  (SELECT max(c.number) FROM counted_edge c JOIN edge e ON e.number = c.edge_number
   WHERE c.robot_id = decision.robot_id AND e.appended_ns <= decision.at_ns), 0)
WHERE how <> 'approved';
CREATE TRIGGER decision_no_update BEFORE UPDATE ON decision BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE INDEX decision_of_no ON decision (robot_id, number) WHERE how <> 'approved';

-- Which decision, standing or policy a row of the audit is about, and its hash, which that of the audit row covers
-- (storage/audited_rows.h). `row_number` of a kind "..._before" is the newest row that was there when the audit began
-- to hold these; the hash is of all of them.

CREATE TABLE audit_row (
  number INTEGER PRIMARY KEY REFERENCES audit,
  kind TEXT NOT NULL CHECK (kind IN ('decision', 'standing', 'policy',
                                     'decision_before', 'standing_before', 'policy_before')),
  row_number INTEGER NOT NULL,
  hash TEXT NOT NULL CHECK (length(hash) = 64),
  UNIQUE (kind, row_number)
) STRICT;

CREATE TRIGGER audit_row_no_update BEFORE UPDATE ON audit_row BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER audit_row_no_delete BEFORE DELETE ON audit_row BEGIN SELECT RAISE(ABORT, 'append-only'); END;

-- What the robot runs, as its drive rule says it: "revision 3, which was rejected".
ALTER TABLE summary_robot ADD COLUMN runs_what TEXT NOT NULL DEFAULT '';
DROP INDEX summary_robot_sorted;
CREATE INDEX summary_robot_sorted ON summary_robot (name_key, verdict, revision_number, calibrated_ns, last_session_ns,
                                                    worst_ratio, sessions, edges, jobs_waiting, max_age_ns, usable_number,
                                                    runs_trouble, found, drift_due_ns, calculating, robot_id, site);
INSERT INTO changed_robot SELECT robot_id FROM robot;
