-- Rig models as people drew them, the parts that sessions name, and epochs that people begin.

CREATE TABLE rig_model (                     -- of each name the newest version holds
  number INTEGER PRIMARY KEY,                -- order of arrival among all
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version > 0),
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  text TEXT NOT NULL,                        -- YAML
  UNIQUE (name, version)
) STRICT;

CREATE TABLE waiting_rig_model (             -- robots whose newest revision was judged before their rig model was set
  robot_id TEXT NOT NULL PRIMARY KEY REFERENCES robot,
  rig_model_number INTEGER NOT NULL REFERENCES rig_model
) STRICT, WITHOUT ROWID;

CREATE TRIGGER rig_model_waits AFTER INSERT ON rig_model
BEGIN
  INSERT INTO waiting_rig_model SELECT DISTINCT robot_id, new.number FROM session_model m
  WHERE rig_model = new.name AND EXISTS (SELECT 1 FROM counted_edge c WHERE c.robot_id = m.robot_id)
  ON CONFLICT (robot_id) DO UPDATE SET rig_model_number = excluded.rig_model_number;
END;
CREATE TRIGGER waiting_rig_model_changes AFTER INSERT ON waiting_rig_model
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;
CREATE TRIGGER waiting_rig_model_gone_changes AFTER DELETE ON waiting_rig_model
BEGIN INSERT INTO changed_robot VALUES (old.robot_id); END;

CREATE TABLE sensor_part (                   -- of closed sessions, of sensors of which they tell either
  robot_id TEXT NOT NULL REFERENCES robot,
  sensor_id TEXT NOT NULL,
  session_number INTEGER NOT NULL REFERENCES session,
  serial TEXT,                               -- NULL: not told
  firmware TEXT,                             -- likewise
  PRIMARY KEY (robot_id, sensor_id, session_number),
  CHECK (serial IS NOT NULL OR firmware IS NOT NULL)
) STRICT, WITHOUT ROWID;

-- A word about a sensor may begin an epoch of it, too.
ALTER TABLE standing RENAME TO standing_26;

CREATE TABLE standing (                      -- of one thing each: a session, an edge or a sensor; the newest word holds
  number INTEGER PRIMARY KEY,                -- order of arrival: the second watermark of revisions
  robot_id TEXT NOT NULL REFERENCES robot,
  at_ns INTEGER NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('pushed', 'pushed_again', 'restored', 'retired', 'epoch')),
  session_number INTEGER REFERENCES session,
  edge_number INTEGER REFERENCES edge,
  sensor_id TEXT,
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  CHECK ((session_number IS NOT NULL) + (edge_number IS NOT NULL) + (sensor_id IS NOT NULL) = 1),
  CHECK (session_number IS NOT NULL OR how IN ('restored', 'retired', 'epoch')),
  CHECK (sensor_id IS NOT NULL OR how <> 'epoch')
) STRICT;

INSERT INTO standing SELECT number, robot_id, at_ns, how, session_number, edge_number, sensor_id, who, reason FROM standing_26;
DROP TABLE standing_26;

CREATE INDEX standing_of_robot ON standing (robot_id);
CREATE INDEX standing_of_session ON standing (session_number) WHERE session_number IS NOT NULL;
CREATE INDEX standing_of_edge ON standing (edge_number) WHERE edge_number IS NOT NULL;
CREATE INDEX standing_of_sensor ON standing (robot_id, sensor_id) WHERE sensor_id IS NOT NULL;
CREATE INDEX standing_retired ON standing (robot_id) WHERE how = 'retired';
CREATE INDEX standing_epoch ON standing (robot_id) WHERE how = 'epoch';

CREATE TRIGGER standing_no_update BEFORE UPDATE ON standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER standing_no_delete BEFORE DELETE ON standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER standing_waits AFTER INSERT ON standing
WHEN EXISTS (SELECT 1 FROM counted_edge WHERE robot_id = new.robot_id)
BEGIN INSERT OR IGNORE INTO waiting_revision VALUES (new.robot_id); END;
CREATE TRIGGER standing_changes AFTER INSERT ON standing
BEGIN INSERT INTO changed_robot VALUES (new.robot_id); END;

CREATE TABLE epoch (                         -- of each word 'epoch'
  standing_number INTEGER PRIMARY KEY REFERENCES standing,
  begins_ns INTEGER                          -- what was measured of the sensor before is past; NULL: the epoch before this
                                             -- word is taken back
) STRICT;

CREATE TRIGGER rig_model_no_update BEFORE UPDATE ON rig_model BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER rig_model_no_delete BEFORE DELETE ON rig_model BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER sensor_part_no_update BEFORE UPDATE ON sensor_part BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER sensor_part_no_delete BEFORE DELETE ON sensor_part BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER epoch_no_update BEFORE UPDATE ON epoch BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER epoch_no_delete BEFORE DELETE ON epoch BEGIN SELECT RAISE(ABORT, 'append-only'); END;
