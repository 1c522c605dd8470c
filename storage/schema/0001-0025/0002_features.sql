-- Views of part of a target, clouds, and what given constants change.

ALTER TABLE detected_view ADD COLUMN corner_idx BLOB CHECK (length(corner_idx) % 8 = 0);  -- doubles; NULL: all points in order

ALTER TABLE edge_contribution ADD COLUMN shifts BLOB CHECK (length(shifts) % 48 = 0);  -- [6] per constant; NULL: not known

CREATE TABLE detected_cloud (                -- what a detector finds in a cloud, by content
  cloud_digest TEXT NOT NULL,
  detector TEXT NOT NULL,                    -- algorithm, version, target geometry
  why_not TEXT NOT NULL,                     -- empty: there are candidates
  target_id TEXT NOT NULL,
  points INTEGER NOT NULL,
  picture_digest TEXT,                       -- NULL: none
  PRIMARY KEY (cloud_digest, detector)
) STRICT, WITHOUT ROWID;

CREATE TABLE detected_patch (                -- candidates of a cloud, the best first
  cloud_digest TEXT NOT NULL,
  detector TEXT NOT NULL,
  patch_idx INTEGER NOT NULL CHECK (patch_idx >= 0),
  summary BLOB NOT NULL CHECK (length(summary) = 80),      -- centre [3], normal [3], extent [2], rms, score
  points_m BLOB NOT NULL CHECK (length(points_m) % 24 = 0),  -- x, y, z, x, ...
  PRIMARY KEY (cloud_digest, detector, patch_idx),
  FOREIGN KEY (cloud_digest, detector) REFERENCES detected_cloud
) STRICT, WITHOUT ROWID;

CREATE TRIGGER detected_cloud_no_update BEFORE UPDATE ON detected_cloud BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER detected_cloud_no_delete BEFORE DELETE ON detected_cloud BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER detected_patch_no_update BEFORE UPDATE ON detected_patch BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER detected_patch_no_delete BEFORE DELETE ON detected_patch BEGIN SELECT RAISE(ABORT, 'append-only'); END;
