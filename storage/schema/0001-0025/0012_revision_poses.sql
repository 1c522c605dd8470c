-- What a revision says of any two of its sensors: read by a query, not derived from all edges again.

CREATE TABLE revision_pose (                 -- of each sensor whose pose is known, the reference too
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  sensor_id TEXT NOT NULL,
  is_reference INTEGER NOT NULL CHECK (is_reference IN (0, 1)),
  T_ref_sensor_x_m REAL NOT NULL,
  T_ref_sensor_y_m REAL NOT NULL,
  T_ref_sensor_z_m REAL NOT NULL,
  T_ref_sensor_qx REAL NOT NULL,
  T_ref_sensor_qy REAL NOT NULL,
  T_ref_sensor_qz REAL NOT NULL,
  T_ref_sensor_qw REAL NOT NULL,
  PRIMARY KEY (robot_id, revision_number, sensor_id),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TABLE revision_covariance (           -- joint, of poses in the reference; of two sensors the first that has both holds
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  idx INTEGER NOT NULL,
  sensors TEXT NOT NULL,                     -- their ids, six rows each, with '/' between: it is in no id
  lower BLOB NOT NULL,                       -- lower triangle, row by row
  PRIMARY KEY (robot_id, revision_number, idx),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

CREATE TRIGGER revision_pose_no_update BEFORE UPDATE ON revision_pose BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_pose_no_delete BEFORE DELETE ON revision_pose BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_covariance_no_update BEFORE UPDATE ON revision_covariance BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_covariance_no_delete BEFORE DELETE ON revision_covariance BEGIN SELECT RAISE(ABORT, 'append-only'); END;
