-- Sessions and sensors are retired as edges are, and what was retired is restored. Finished edges say when they were measured.

ALTER TABLE standing RENAME TO standing_17;

CREATE TABLE standing (                      -- of one thing each: a session, an edge or a sensor; the newest word holds
  number INTEGER PRIMARY KEY,                -- order of arrival: the second watermark of revisions
  robot_id TEXT NOT NULL REFERENCES robot,
  at_ns INTEGER NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('pushed', 'pushed_again', 'restored', 'retired')),
  session_number INTEGER REFERENCES session,
  edge_number INTEGER REFERENCES edge,
  sensor_id TEXT,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  CHECK ((session_number IS NOT NULL) + (edge_number IS NOT NULL) + (sensor_id IS NOT NULL) = 1),
  CHECK (session_number IS NOT NULL OR how IN ('restored', 'retired'))
) STRICT;

INSERT INTO standing SELECT number, robot_id, at_ns, how, session_number, edge_number, NULL, who, reason FROM standing_17;
DROP TABLE standing_17;

CREATE INDEX standing_of_robot ON standing (robot_id);
CREATE INDEX standing_of_session ON standing (session_number) WHERE session_number IS NOT NULL;
CREATE INDEX standing_of_edge ON standing (edge_number) WHERE edge_number IS NOT NULL;
CREATE INDEX standing_of_sensor ON standing (robot_id, sensor_id) WHERE sensor_id IS NOT NULL;
CREATE INDEX standing_retired ON standing (robot_id) WHERE how = 'retired';

CREATE TRIGGER standing_no_update BEFORE UPDATE ON standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER standing_no_delete BEFORE DELETE ON standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER standing_waits AFTER INSERT ON standing
WHEN EXISTS (SELECT 1 FROM counted_edge WHERE robot_id = new.robot_id)
BEGIN INSERT OR IGNORE INTO waiting_revision VALUES (new.robot_id); END;
CREATE TRIGGER standing_changes AFTER INSERT ON standing
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;

CREATE TABLE session_reference (             -- that each closed session names
  session_number INTEGER PRIMARY KEY REFERENCES session,
  sensor_id TEXT NOT NULL
) STRICT;

INSERT INTO session_reference
  SELECT number, json_extract(manifest, '$.reference') FROM session
  JOIN session_closed ON session_closed.session_number = session.number WHERE json_extract(manifest, '$.reference') IS NOT NULL;

CREATE TRIGGER session_reference_no_update BEFORE UPDATE ON session_reference BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_reference_no_delete BEFORE DELETE ON session_reference BEGIN SELECT RAISE(ABORT, 'append-only'); END;

ALTER TABLE edge ADD COLUMN measured_ns INTEGER;  -- as it was told; NULL: when its session was captured, or it was stored
