-- The limits that people set, as they wrote them, and by which of them a revision was judged.

CREATE TABLE policy (                        -- of each scope and subject the newest holds
  number INTEGER PRIMARY KEY,                -- order of arrival among all
  scope TEXT NOT NULL CHECK (scope IN ('fleet', 'model', 'robot')),
  subject TEXT NOT NULL,                     -- rig model or robot; empty of the fleet
  version INTEGER NOT NULL CHECK (version > 0),
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  text TEXT NOT NULL,                        -- YAML
  UNIQUE (scope, subject, version),
  CHECK ((scope = 'fleet') = (subject = ''))
) STRICT;

CREATE TABLE revision_judgement (            -- of every revision since this version
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  policy_watermark INTEGER NOT NULL,         -- number of the newest policy of all when it was judged; 0: none
  max_age_ns INTEGER NOT NULL,               -- of that policy: older than this it is overdue
  unverified TEXT NOT NULL,                  -- sensors not to be relied on, as a sentence names them; empty: all or none
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TABLE session_model (                 -- of closed sessions that say it
  robot_id TEXT NOT NULL REFERENCES robot,
  captured_ns INTEGER NOT NULL,
  session_number INTEGER NOT NULL REFERENCES session,
  rig_model TEXT NOT NULL,
  PRIMARY KEY (robot_id, captured_ns, session_number)
) STRICT, WITHOUT ROWID;
CREATE INDEX session_model_robots ON session_model (rig_model, robot_id);

INSERT INTO session_model
  SELECT robot_id, captured_ns, number, json_extract(manifest, '$.rig_model') FROM session
  JOIN session_closed ON session_number = number WHERE json_extract(manifest, '$.rig_model') <> '';

CREATE TABLE waiting_verdict (               -- robots whose newest revision was judged before a policy of theirs was set
  robot_id TEXT NOT NULL PRIMARY KEY REFERENCES robot,
  policy_number INTEGER NOT NULL REFERENCES policy,
  of_robot INTEGER NOT NULL CHECK (of_robot IN (0, 1))  -- it is its own: somebody waits for it
) STRICT, WITHOUT ROWID;
CREATE INDEX waiting_verdict_of_robot ON waiting_verdict (robot_id) WHERE of_robot = 1;

CREATE TRIGGER policy_of_fleet_waits AFTER INSERT ON policy WHEN new.scope = 'fleet'
BEGIN
  INSERT INTO waiting_verdict SELECT robot_id, new.number, 0 FROM robot r
  WHERE EXISTS (SELECT 1 FROM counted_edge c WHERE c.robot_id = r.robot_id)
  ON CONFLICT (robot_id) DO UPDATE SET policy_number = excluded.policy_number;
END;
CREATE TRIGGER policy_of_model_waits AFTER INSERT ON policy WHEN new.scope = 'model'
BEGIN
  INSERT INTO waiting_verdict SELECT DISTINCT robot_id, new.number, 0 FROM session_model m
  WHERE rig_model = new.subject AND EXISTS (SELECT 1 FROM counted_edge c WHERE c.robot_id = m.robot_id)
  ON CONFLICT (robot_id) DO UPDATE SET policy_number = excluded.policy_number;
END;
CREATE TRIGGER policy_of_robot_waits AFTER INSERT ON policy WHEN new.scope = 'robot'
BEGIN
  INSERT INTO waiting_verdict SELECT robot_id, new.number, 1 FROM robot r
  WHERE robot_id = new.subject AND EXISTS (SELECT 1 FROM counted_edge c WHERE c.robot_id = r.robot_id)
  ON CONFLICT (robot_id) DO UPDATE SET policy_number = excluded.policy_number, of_robot = 1;
END;

-- That it is judged anew is part of what is said of a robot at a glance.
CREATE TRIGGER waiting_verdict_changes AFTER INSERT ON waiting_verdict
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;
CREATE TRIGGER waiting_verdict_gone_changes AFTER DELETE ON waiting_verdict
BEGIN INSERT INTO changed_robot VALUES (old.robot_id); END;

ALTER TABLE summary_robot ADD COLUMN max_age_ns INTEGER NOT NULL DEFAULT 7776000000000000;  -- older than this it is overdue
ALTER TABLE summary_robot ADD COLUMN unverified TEXT NOT NULL DEFAULT '';                   -- as of its revision
DROP INDEX summary_robot_sorted;
CREATE INDEX summary_robot_sorted ON summary_robot (name_key, verdict, revision_number, calibrated_ns, last_session_ns,
                                                    worst_ratio, sessions, edges, jobs_waiting, max_age_ns);

CREATE TRIGGER policy_no_update BEFORE UPDATE ON policy BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER policy_no_delete BEFORE DELETE ON policy BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_judgement_no_update BEFORE UPDATE ON revision_judgement BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_judgement_no_delete BEFORE DELETE ON revision_judgement BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_model_no_update BEFORE UPDATE ON session_model BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_model_no_delete BEFORE DELETE ON session_model BEGIN SELECT RAISE(ABORT, 'append-only'); END;
