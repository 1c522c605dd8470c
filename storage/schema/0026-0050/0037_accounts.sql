-- Who may use the server over HTTP: people with passwords, and programs with tokens.

CREATE TABLE account (                       -- of each name the newest row holds
  number INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  role TEXT NOT NULL CHECK (role IN ('viewer', 'technician', 'approver', 'admin', 'none')),  -- none: removed
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL
) STRICT;
CREATE INDEX account_of_name ON account (name, number);

CREATE TABLE access_token (
  number INTEGER PRIMARY KEY,
  name TEXT NOT NULL,                        -- of the program
  role TEXT NOT NULL CHECK (role IN ('viewer', 'technician', 'approver', 'admin')),
  digest TEXT NOT NULL UNIQUE CHECK (length(digest) = 64),  -- sha256 of the secret
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL
) STRICT;

CREATE TABLE access_token_revoked (
  token_number INTEGER PRIMARY KEY REFERENCES access_token,
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL
) STRICT;

-- What is not append-only, so that nothing stays of a secret that is good no longer.

CREATE TABLE login_password (                -- of the accounts that there are
  name TEXT PRIMARY KEY,
  password_hash TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE login_session (
  digest TEXT PRIMARY KEY CHECK (length(digest) = 64),      -- sha256 of the secret that the browser has
  account_number INTEGER NOT NULL REFERENCES account,       -- good while this is the newest of its name
  began_ns INTEGER NOT NULL,
  seen_ns INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX login_session_of_account ON login_session (account_number);

CREATE TRIGGER account_no_update BEFORE UPDATE ON account BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER account_no_delete BEFORE DELETE ON account BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER access_token_no_update BEFORE UPDATE ON access_token BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER access_token_no_delete BEFORE DELETE ON access_token BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER access_token_revoked_no_update BEFORE UPDATE ON access_token_revoked BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER access_token_revoked_no_delete BEFORE DELETE ON access_token_revoked BEGIN SELECT RAISE(ABORT, 'append-only'); END;
