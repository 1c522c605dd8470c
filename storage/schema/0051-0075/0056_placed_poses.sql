-- What a revision keeps of its moment: poses that are known in part, and by what it was made.

CREATE TABLE revision_placed (               -- where it put its sensors by the graph of pairs, if any is known in part
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  reference TEXT NOT NULL,
  sensors TEXT NOT NULL,                     -- the others that have a place, with '/' between: it is in no id
  poses BLOB NOT NULL,                       -- of each T_ref_sensor: x, y, z in m, qx, qy, qz, qw
  lower BLOB NOT NULL,                       -- of their joint covariance, the lower triangle, row by row
  motions BLOB NOT NULL,                     -- of each free motion, one after the other: six numbers per sensor
  scale BLOB NOT NULL,                       -- six numbers, by which metres and radians were compared
  visible_ratio REAL NOT NULL,               -- what of a motion, scaled, is more than noise
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TABLE revision_made (
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  software TEXT NOT NULL,                    -- the version of rigcald that solved it
  in_use INTEGER,                            -- the revision that the robot was to use once this one was stored; NULL: none
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TRIGGER revision_placed_no_update BEFORE UPDATE ON revision_placed BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_placed_no_delete BEFORE DELETE ON revision_placed BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_made_no_update BEFORE UPDATE ON revision_made BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_made_no_delete BEFORE DELETE ON revision_made BEGIN SELECT RAISE(ABORT, 'append-only'); END;
