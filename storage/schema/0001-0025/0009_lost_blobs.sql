-- Contents that were held and that the disk has not kept: they count as not held until they are sent again.

CREATE TABLE blob_lost (
  number INTEGER PRIMARY KEY,
  digest TEXT NOT NULL CHECK (length(digest) = 64),
  why TEXT NOT NULL CHECK (why IN ('damaged', 'missing')),
  lost_ns INTEGER NOT NULL
) STRICT;

CREATE TABLE waiting_blob (                  -- lost, and not sent again yet
  digest TEXT NOT NULL PRIMARY KEY,
  lost_number INTEGER NOT NULL REFERENCES blob_lost
) STRICT, WITHOUT ROWID;

CREATE TABLE waiting_rerun (                 -- jobs whose edge failed for want of it: queued again when it is there
  digest TEXT NOT NULL REFERENCES waiting_blob ON DELETE CASCADE,
  job_number INTEGER NOT NULL REFERENCES job,
  PRIMARY KEY (digest, job_number)
) STRICT, WITHOUT ROWID;
CREATE INDEX waiting_rerun_of_job ON waiting_rerun (job_number);

CREATE TRIGGER blob_lost_no_update BEFORE UPDATE ON blob_lost BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER blob_lost_no_delete BEFORE DELETE ON blob_lost BEGIN SELECT RAISE(ABORT, 'append-only'); END;
