-- What holds the audit together: each row's hash covers the row and the hash before it (storage/audit_chain.h). The rows
-- of before get theirs when the store is migrated.

CREATE TABLE audit_chain (
  number INTEGER PRIMARY KEY REFERENCES audit,
  robot_id TEXT,                             -- that it is about; NULL: none, or several
  hash TEXT NOT NULL CHECK (length(hash) = 64)
) STRICT;
CREATE INDEX audit_chain_of_robot ON audit_chain (robot_id, number) WHERE robot_id IS NOT NULL;

CREATE TRIGGER audit_chain_no_update BEFORE UPDATE ON audit_chain BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER audit_chain_no_delete BEFORE DELETE ON audit_chain BEGIN SELECT RAISE(ABORT, 'append-only'); END;
