-- That a revision waits for somebody's word, or that a robot does not run what is in use, is a status.

ALTER TABLE summary_robot ADD COLUMN apply_by_ns INTEGER;  -- until then it may take to apply what is in use; NULL: no excuse

ALTER TABLE robot_status RENAME TO robot_status_45;
CREATE TABLE robot_status (                  -- each change; of each robot the newest holds
  number INTEGER PRIMARY KEY,
  robot_id TEXT NOT NULL REFERENCES robot,
  at_ns INTEGER NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('ok', 'due', 'overdue', 'not-applied', 'to-approve', 'drifted', 'out-of-tolerance',
                                         'failed', 'unknown')),
  why TEXT NOT NULL,
  next_step TEXT NOT NULL
) STRICT;
INSERT INTO robot_status SELECT number, robot_id, at_ns, status, why, next_step FROM robot_status_45;
DROP TABLE robot_status_45;
CREATE INDEX robot_status_of_robot ON robot_status (robot_id, number);
CREATE TRIGGER robot_status_no_update BEFORE UPDATE ON robot_status BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER robot_status_no_delete BEFORE DELETE ON robot_status BEGIN SELECT RAISE(ABORT, 'append-only'); END;

DROP INDEX summary_robot_sorted;
CREATE INDEX summary_robot_sorted ON summary_robot (name_key, verdict, revision_number, calibrated_ns, last_session_ns,
                                                    worst_ratio, sessions, edges, jobs_waiting, max_age_ns, usable_number,
                                                    runs_trouble, found, drift_due_ns, calculating, robot_id, site, rig_model,
                                                    operator_name, state, apply_by_ns);
DROP INDEX summary_robot_of_model;
CREATE INDEX summary_robot_of_model ON summary_robot (rig_model, revision_number, verdict, found, calibrated_ns, max_age_ns,
                                                      drift_due_ns, usable_number, state, runs_trouble);
INSERT INTO changed_robot SELECT robot_id FROM robot;
