-- Where the newest revision is not in use, calibrated_ns, max_age_ns and drift_due_ns of summary_robot are of the one that is.

INSERT INTO changed_robot SELECT robot_id FROM robot;
