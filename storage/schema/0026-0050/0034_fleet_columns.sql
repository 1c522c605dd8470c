-- Columns of the lists of robots: what kind of machine each is, who captured its newest session, and how its calibrations
-- followed each other.

ALTER TABLE summary_robot ADD COLUMN rig_model TEXT NOT NULL DEFAULT '';      -- empty: no session names one
ALTER TABLE summary_robot ADD COLUMN operator_name TEXT NOT NULL DEFAULT '';  -- of the newest session that came whole
ALTER TABLE summary_robot ADD COLUMN calibrations TEXT NOT NULL DEFAULT '';   -- the newest 26 (storage/fleet/calibration_series.h)
DROP INDEX summary_robot_sorted;
CREATE INDEX summary_robot_sorted ON summary_robot (name_key, verdict, revision_number, calibrated_ns, last_session_ns,
                                                    worst_ratio, sessions, edges, jobs_waiting, max_age_ns, usable_number,
                                                    runs_trouble, found, drift_due_ns, calculating, robot_id, site, rig_model,
                                                    operator_name);
-- What the robots of each rig model are counted by, in one go and without sorting.
CREATE INDEX summary_robot_of_model ON summary_robot (rig_model, revision_number, verdict, found, calibrated_ns, max_age_ns,
                                                      drift_due_ns);
INSERT INTO changed_robot SELECT robot_id FROM robot;
