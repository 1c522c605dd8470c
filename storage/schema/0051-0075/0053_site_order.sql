-- Sessions that a site sends on late: what supersedes them there may be whole here before them.

CREATE TABLE waiting_superseded (            -- of sessions that are not whole here yet
  session_id TEXT NOT NULL,
  by_id TEXT NOT NULL,                       -- a session that supersedes it at the site; known here or not
  PRIMARY KEY (session_id, by_id)
) STRICT, WITHOUT ROWID;
