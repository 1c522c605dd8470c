-- A decision holds what it is about, not its number alone: the document of the revision and its poses, as they were then.

ALTER TABLE decision ADD COLUMN digest TEXT CHECK (length(digest) = 64);          -- of the document; NULL: from before
ALTER TABLE decision ADD COLUMN poses_hash TEXT CHECK (length(poses_hash) = 64);  -- of its poses (storage/revisions/decided_content.h); NULL likewise

-- The audit holds rig models and measures of boards, too.
ALTER TABLE audit_row RENAME TO audit_row_48;

CREATE TABLE audit_row (                     -- as in 0030_held_decisions.sql
  number INTEGER PRIMARY KEY REFERENCES audit,
  kind TEXT NOT NULL CHECK (kind IN ('decision', 'standing', 'policy', 'rig_model', 'board_measure', 'decision_before',
                                     'standing_before', 'policy_before', 'rig_model_before', 'board_measure_before')),
  row_number INTEGER NOT NULL,
  hash TEXT NOT NULL CHECK (length(hash) = 64),
  UNIQUE (kind, row_number)
) STRICT;
INSERT INTO audit_row SELECT number, kind, row_number, hash FROM audit_row_48;
DROP TABLE audit_row_48;

CREATE TRIGGER audit_row_no_update BEFORE UPDATE ON audit_row BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER audit_row_no_delete BEFORE DELETE ON audit_row BEGIN SELECT RAISE(ABORT, 'append-only'); END;
