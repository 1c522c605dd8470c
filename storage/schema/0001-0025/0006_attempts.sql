-- Pieces of work that were begun, and how each attempt ended: what kills the process is begun so often and no more.

CREATE TABLE attempt (
  number INTEGER PRIMARY KEY,                -- oldest first
  work TEXT NOT NULL,                        -- 'job 7', 'report mapper-01 3', 'revision mapper-01 4711'
  started_ns INTEGER NOT NULL
) STRICT;
CREATE INDEX attempt_of_work ON attempt (work, number);

CREATE TABLE attempt_ended (                 -- none: under way, or cut off and not yet found to be
  attempt_number INTEGER PRIMARY KEY REFERENCES attempt,
  ended_ns INTEGER NOT NULL,
  how TEXT NOT NULL CHECK (how IN ('done', 'failed', 'given_back', 'cut_off')),
  why TEXT NOT NULL                          -- of a failed one; else empty
) STRICT;

CREATE TABLE waiting_attempt (               -- work that was begun and is not done
  work TEXT NOT NULL PRIMARY KEY,
  attempts INTEGER NOT NULL CHECK (attempts >= 0),  -- without those given back; with the one under way
  open_number INTEGER REFERENCES attempt     -- under way; NULL: none
) STRICT, WITHOUT ROWID;

CREATE TRIGGER attempt_no_update BEFORE UPDATE ON attempt BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER attempt_no_delete BEFORE DELETE ON attempt BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER attempt_ended_no_update BEFORE UPDATE ON attempt_ended BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER attempt_ended_no_delete BEFORE DELETE ON attempt_ended BEGIN SELECT RAISE(ABORT, 'append-only'); END;
