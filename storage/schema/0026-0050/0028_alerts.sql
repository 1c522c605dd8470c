-- Where each robot stands with its calibration, by when it is due, and who is told of changes.

CREATE TABLE revision_status (               -- of revisions that were judged, since this version
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  zstd BLOB NOT NULL,                        -- one frame: status of its sensors, as JSON
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT;

CREATE TABLE model_visit (                   -- of each session the first revision with it, where that tells what was found
  number INTEGER PRIMARY KEY,                -- order of arrival
  rig_model TEXT NOT NULL,
  robot_id TEXT NOT NULL,
  session_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  UNIQUE (robot_id, session_id),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT;
CREATE INDEX model_visit_of_model ON model_visit (rig_model, number);
CREATE INDEX model_visit_of_robot ON model_visit (robot_id, number);

INSERT INTO model_visit (rig_model, robot_id, session_id, revision_number)
  SELECT m.rig_model, f.robot_id, f.session_id, min(f.revision_number) FROM revision_as_found f
  JOIN session s ON s.session_id = f.session_id JOIN session_model m ON m.session_number = s.number
  WHERE m.robot_id = f.robot_id AND m.captured_ns = s.captured_ns
  GROUP BY f.robot_id, f.session_id ORDER BY min(f.revision_number), f.robot_id;

CREATE TABLE robot_status (                  -- each change; of each robot the newest holds
  number INTEGER PRIMARY KEY,
  robot_id TEXT NOT NULL REFERENCES robot,
  at_ns INTEGER NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('ok', 'due', 'overdue', 'drifted', 'out-of-tolerance', 'failed', 'unknown')),
  why TEXT NOT NULL,
  next_step TEXT NOT NULL
) STRICT;
CREATE INDEX robot_status_of_robot ON robot_status (robot_id, number);

CREATE TABLE webhook (                       -- receivers; of each address the newest word holds
  number INTEGER PRIMARY KEY,
  url TEXT NOT NULL,
  at_ns INTEGER NOT NULL,
  is_told INTEGER NOT NULL CHECK (is_told IN (0, 1))  -- of what happens from now on
) STRICT;
CREATE INDEX webhook_of_url ON webhook (url, number);

CREATE TABLE alert (                         -- what happened, as receivers are told
  number INTEGER PRIMARY KEY,
  id TEXT NOT NULL UNIQUE CHECK (length(id) = 64),
  robot_id TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('status', 'approved', 'rejected', 'rolled_back', 'session_failed')),
  subject TEXT NOT NULL,                     -- status, number of a revision, or session
  at_ns INTEGER NOT NULL,
  body TEXT NOT NULL                         -- JSON, byte for byte as it is sent
) STRICT;
CREATE INDEX alert_of_subject ON alert (robot_id, kind, subject);

CREATE TABLE waiting_alert (                 -- of each receiver that was there when it happened: not delivered yet
  url TEXT NOT NULL,
  alert_number INTEGER NOT NULL REFERENCES alert,
  robot_id TEXT NOT NULL,
  attempts INTEGER NOT NULL,
  next_try_ns INTEGER NOT NULL,
  last_error TEXT NOT NULL,                  -- empty: none yet
  PRIMARY KEY (url, alert_number)
) STRICT, WITHOUT ROWID;
CREATE INDEX waiting_alert_of_robot ON waiting_alert (url, robot_id, alert_number);

CREATE TABLE alert_delivered (
  url TEXT NOT NULL,
  alert_number INTEGER NOT NULL REFERENCES alert,
  at_ns INTEGER NOT NULL,
  http_status INTEGER NOT NULL CHECK (http_status BETWEEN 200 AND 299),
  PRIMARY KEY (url, alert_number)
) STRICT, WITHOUT ROWID;

-- In the transaction in which it happens.
CREATE TRIGGER alert_waits AFTER INSERT ON alert
BEGIN
  INSERT INTO waiting_alert SELECT url, new.number, new.robot_id, 0, 0, '' FROM webhook w
  WHERE is_told = 1 AND number = (SELECT max(number) FROM webhook other WHERE other.url = w.url);
END;

CREATE TRIGGER revision_status_changes AFTER INSERT ON revision_status
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;

ALTER TABLE summary_robot ADD COLUMN found TEXT NOT NULL DEFAULT 'ok';  -- worst of its sensors, whatever the time
ALTER TABLE summary_robot ADD COLUMN found_why TEXT NOT NULL DEFAULT '';
ALTER TABLE summary_robot ADD COLUMN found_next_step TEXT NOT NULL DEFAULT '';
ALTER TABLE summary_robot ADD COLUMN drift_due_ns INTEGER;              -- NULL: not before the age that the policy allows
ALTER TABLE summary_robot ADD COLUMN drift_sensor TEXT NOT NULL DEFAULT '';
ALTER TABLE summary_robot ADD COLUMN drift_law TEXT NOT NULL DEFAULT '';
ALTER TABLE summary_robot ADD COLUMN drift_visits INTEGER NOT NULL DEFAULT 0;
ALTER TABLE summary_robot ADD COLUMN drift_robots INTEGER NOT NULL DEFAULT 0;
ALTER TABLE summary_robot ADD COLUMN site TEXT NOT NULL DEFAULT '';
DROP INDEX summary_robot_sorted;
CREATE INDEX summary_robot_sorted ON summary_robot (name_key, verdict, revision_number, calibrated_ns, last_session_ns,
                                                    worst_ratio, sessions, edges, jobs_waiting, max_age_ns, found, drift_due_ns,
                                                    calculating, robot_id, site);

CREATE TRIGGER revision_status_no_update BEFORE UPDATE ON revision_status BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_status_no_delete BEFORE DELETE ON revision_status BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER model_visit_no_update BEFORE UPDATE ON model_visit BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER model_visit_no_delete BEFORE DELETE ON model_visit BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER robot_status_no_update BEFORE UPDATE ON robot_status BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER robot_status_no_delete BEFORE DELETE ON robot_status BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER webhook_no_update BEFORE UPDATE ON webhook BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER webhook_no_delete BEFORE DELETE ON webhook BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER alert_no_update BEFORE UPDATE ON alert BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER alert_no_delete BEFORE DELETE ON alert BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER alert_delivered_no_update BEFORE UPDATE ON alert_delivered BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER alert_delivered_no_delete BEFORE DELETE ON alert_delivered BEGIN SELECT RAISE(ABORT, 'append-only'); END;
