-- Documents of revisions are kept compressed, and what ten years of visits left is listed by pages.

CREATE TABLE revision_document (             -- revision.document is then empty; that of older revisions is there
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  zstd BLOB NOT NULL,                        -- one frame; revision.digest is that of the text in it
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT;

CREATE TABLE merge_state_edge (              -- merged edges of the robot's newest revision, by the id that they have in it
  edge_id TEXT NOT NULL PRIMARY KEY,
  robot_id TEXT NOT NULL REFERENCES robot
) STRICT, WITHOUT ROWID;
CREATE INDEX merge_state_edge_of_robot ON merge_state_edge (robot_id);

CREATE INDEX session_captured ON session (captured_ns);  -- pages of the sessions of all robots

CREATE TRIGGER revision_document_no_update BEFORE UPDATE ON revision_document BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_document_no_delete BEFORE DELETE ON revision_document BEGIN SELECT RAISE(ABORT, 'append-only'); END;
