-- Sites: a server that sends on to a centre what robots pushed to it, and the centre's side of that.

CREATE TABLE centre (                        -- where to; the newest word holds, an empty address: nowhere
  number INTEGER PRIMARY KEY,
  url TEXT NOT NULL,
  at_ns INTEGER NOT NULL
) STRICT;

CREATE TABLE waiting_forward (               -- whole sessions and whole batches of edges that the centre does not have yet
  number INTEGER PRIMARY KEY,                -- the oldest first
  kind TEXT NOT NULL CHECK (kind IN ('session', 'batch')),
  subject TEXT NOT NULL,                     -- the id of either
  robot_id TEXT NOT NULL REFERENCES robot,
  since_ns INTEGER NOT NULL,                 -- when it was whole here; of a batch, when what came before its last items did
  next_try_ns INTEGER NOT NULL,              -- 0: it was not refused
  attempts INTEGER NOT NULL,                 -- in vain, one after the other
  failing_ns INTEGER,                        -- when the first of them was; NULL: none
  last_error TEXT NOT NULL,                  -- empty: none
  UNIQUE (kind, subject)
) STRICT;

CREATE TABLE forwarded (                     -- what a centre has confirmed to have on its disk
  url TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('session', 'batch')),
  subject TEXT NOT NULL,
  at_ns INTEGER NOT NULL,
  PRIMARY KEY (url, kind, subject)
) STRICT, WITHOUT ROWID;

-- In the transaction with which it is whole.
CREATE TRIGGER session_closed_waits_forward AFTER INSERT ON session_closed
BEGIN
  INSERT INTO waiting_forward (kind, subject, robot_id, since_ns, next_try_ns, attempts, last_error)
  SELECT 'session', s.session_id, s.robot_id, new.closed_ns, 0, 0, '' FROM session s, centre c
  WHERE s.number = new.session_number AND c.number = (SELECT max(number) FROM centre) AND c.url <> ''
  ON CONFLICT DO NOTHING;
END;

CREATE TRIGGER batch_waits_forward AFTER DELETE ON waiting_batch
BEGIN
  INSERT INTO waiting_forward (kind, subject, robot_id, since_ns, next_try_ns, attempts, last_error)
  SELECT 'batch', b.batch_id, b.robot_id, old.newest_ns, 0, 0, '' FROM batch b, centre c
  WHERE b.number = old.batch_number AND c.number = (SELECT max(number) FROM centre) AND c.url <> ''
  ON CONFLICT DO NOTHING;
END;

CREATE TABLE access_token_site (             -- tokens of servers of sites: access_token calls them viewers, and they may do nothing else
  token_number INTEGER PRIMARY KEY REFERENCES access_token,
  robots TEXT NOT NULL                       -- of which robots they may send on: names, '*' for any end, with commas between
) STRICT;

CREATE TRIGGER centre_no_update BEFORE UPDATE ON centre BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER centre_no_delete BEFORE DELETE ON centre BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER forwarded_no_update BEFORE UPDATE ON forwarded BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER forwarded_no_delete BEFORE DELETE ON forwarded BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER access_token_site_no_update BEFORE UPDATE ON access_token_site BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER access_token_site_no_delete BEFORE DELETE ON access_token_site BEGIN SELECT RAISE(ABORT, 'append-only'); END;
