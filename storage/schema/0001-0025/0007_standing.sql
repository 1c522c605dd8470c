-- What counts, and who said so: sessions that were made current, edges that were retired. The newest word holds.

CREATE TABLE standing (
  number INTEGER PRIMARY KEY,                -- order of arrival: the second watermark of revisions
  robot_id TEXT NOT NULL REFERENCES robot,
  at_ns INTEGER NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('pushed', 'pushed_again', 'restored', 'retired')),
  session_number INTEGER REFERENCES session, -- made current
  edge_number INTEGER UNIQUE REFERENCES edge,-- retired
  who TEXT NOT NULL,
  reason TEXT NOT NULL,
  CHECK ((how = 'retired') = (edge_number IS NOT NULL) AND (how = 'retired') = (session_number IS NULL))
) STRICT;
CREATE INDEX standing_of_robot ON standing (robot_id);
CREATE INDEX standing_of_session ON standing (session_number) WHERE session_number IS NOT NULL;

INSERT INTO standing (robot_id, at_ns, how, session_number, who, reason)
  SELECT session.robot_id, closed_ns, 'pushed', session.number, 'robot ' || session.robot_id, ''
  FROM session_closed JOIN session ON session.number = session_number ORDER BY session.number;

CREATE TABLE revision_standing (             -- of every revision; of those made before, the newest of each robot
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  standing_watermark INTEGER NOT NULL,       -- number of the robot's newest standing that it counts
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

INSERT INTO revision_standing
  SELECT robot_id, max(number),
         coalesce((SELECT max(standing.number) FROM standing WHERE standing.robot_id = revision.robot_id), 0)
  FROM revision GROUP BY robot_id;

CREATE TABLE robot_digest_held (             -- contents that the robot sent, in any of its sessions
  robot_id TEXT NOT NULL REFERENCES robot,
  digest TEXT NOT NULL,
  held_ns INTEGER NOT NULL,
  PRIMARY KEY (robot_id, digest)
) STRICT, WITHOUT ROWID;

INSERT INTO robot_digest_held
  SELECT session.robot_id, payload.digest, min(payload_held.held_ns)
  FROM payload_held JOIN payload USING (session_number, idx) JOIN session ON session.number = payload.session_number
  GROUP BY session.robot_id, payload.digest;
DROP TABLE digest_held;                      -- by whatever robot

CREATE TRIGGER standing_no_update BEFORE UPDATE ON standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER standing_no_delete BEFORE DELETE ON standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_standing_no_update BEFORE UPDATE ON revision_standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_standing_no_delete BEFORE DELETE ON revision_standing BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER robot_digest_held_no_update BEFORE UPDATE ON robot_digest_held BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER robot_digest_held_no_delete BEFORE DELETE ON robot_digest_held BEGIN SELECT RAISE(ABORT, 'append-only'); END;
