-- Several servers on one store: who serves, what each of them is to tell on its DDS network, and who sends which alert.

CREATE TABLE lease_server (
  owner TEXT PRIMARY KEY,                    -- the process
  until_ns INTEGER NOT NULL                  -- by store_clock: it is there until then, and says so again before
) STRICT, WITHOUT ROWID;

CREATE TABLE lease_receiver (                -- addresses that a server sends alerts to
  owner TEXT NOT NULL,
  url TEXT NOT NULL,
  PRIMARY KEY (owner, url)
) STRICT, WITHOUT ROWID;

CREATE TABLE lease_alert (                   -- alerts that a server is about to send
  url TEXT NOT NULL,
  alert_number INTEGER NOT NULL,
  until_ns INTEGER NOT NULL,                 -- by store_clock: nobody else sends it before
  PRIMARY KEY (url, alert_number)
) STRICT, WITHOUT ROWID;

DELETE FROM waiting_announcement;            -- of nobody: an event is of the moment
ALTER TABLE waiting_announcement ADD COLUMN server TEXT NOT NULL DEFAULT '';  -- that is to tell it
CREATE INDEX waiting_announcement_of_server ON waiting_announcement (server, number);
