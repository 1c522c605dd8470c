-- Several processes on one store: who works on which robot, and what those that are not on DDS want told there.

-- The store's clock, in nanoseconds, to a millisecond: leases are not held by the clocks of many machines.
CREATE VIEW store_clock (now_ns) AS SELECT CAST((julianday('now') - 2440587.5) * 86400000.0 AS BIGINT) * 1000000;

CREATE TABLE lease_robot (
  robot_id TEXT PRIMARY KEY,
  token INTEGER NOT NULL,                    -- grows each time that somebody takes it
  owner TEXT NOT NULL,                       -- the process; empty: it was given back
  until_ns INTEGER NOT NULL                  -- by store_clock: from then on others may take it
) STRICT, WITHOUT ROWID;
CREATE INDEX lease_of_owner ON lease_robot (owner, until_ns);

CREATE TABLE waiting_announcement (
  number INTEGER PRIMARY KEY,
  robot_id TEXT NOT NULL,
  kind TEXT NOT NULL,                        -- of an event; empty: the robot's state is another
  subject TEXT NOT NULL,
  json TEXT NOT NULL,
  at_ns INTEGER NOT NULL
) STRICT;

CREATE TABLE lease_folder (                  -- of a store on a server: the folder with its files has the same id (files/store_id.h)
  store_id TEXT PRIMARY KEY
) STRICT, WITHOUT ROWID;
