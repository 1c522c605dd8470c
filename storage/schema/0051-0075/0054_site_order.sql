-- Sessions that a site sends on late: what supersedes them there may be whole here before them.

CREATE TABLE waiting_superseded (            -- of sessions that are not whole here yet
  session_id TEXT NOT NULL,
  by_id TEXT NOT NULL,                       -- a session that supersedes it at the site; known here or not
  PRIMARY KEY (session_id, by_id)
) STRICT, WITHOUT ROWID;

-- What a centre confirmed last no clock says.
ALTER TABLE forwarded RENAME TO forwarded_47;
CREATE TABLE forwarded (                     -- what a centre has confirmed to have on its disk
  number INTEGER PRIMARY KEY,                -- in the order in which it did, also again, after it had lost it
  url TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('session', 'batch')),
  subject TEXT NOT NULL,
  robot_id TEXT NOT NULL REFERENCES robot,
  at_ns INTEGER NOT NULL
) STRICT;
INSERT INTO forwarded (url, kind, subject, robot_id, at_ns)
  SELECT f.url, f.kind, f.subject, coalesce(s.robot_id, b.robot_id), f.at_ns FROM forwarded_47 f
  LEFT JOIN session s ON f.kind = 'session' AND s.session_id = f.subject
  LEFT JOIN batch b ON f.kind = 'batch' AND b.batch_id = f.subject
  WHERE coalesce(s.robot_id, b.robot_id) IS NOT NULL ORDER BY f.at_ns, f.kind, f.subject;
DROP TABLE forwarded_47;
CREATE INDEX forwarded_subject ON forwarded (url, kind, subject);
CREATE TRIGGER forwarded_no_update BEFORE UPDATE ON forwarded BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER forwarded_no_delete BEFORE DELETE ON forwarded BEGIN SELECT RAISE(ABORT, 'append-only'); END;
