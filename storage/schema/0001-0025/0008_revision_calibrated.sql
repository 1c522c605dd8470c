-- When what a revision counts was measured: the newest capture of its good edges; of pushed ones, when they were stored.
-- A revision that counts nothing has no row.

CREATE TABLE revision_calibrated (
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  calibrated_ns INTEGER NOT NULL,
  PRIMARY KEY (robot_id, revision_number),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;

-- Of revisions made before, which of their edges counted stands in their documents only: all good ones are taken.
INSERT INTO revision_calibrated
SELECT r.robot_id, r.number, max(coalesce(s.captured_ns, e.appended_ns)) FROM revision r
JOIN edge e ON e.robot_id = r.robot_id AND e.number <= r.edge_watermark AND e.state = 'good'
LEFT JOIN session s ON s.session_id = e.session_id
GROUP BY r.robot_id, r.number;

CREATE TRIGGER revision_calibrated_no_update BEFORE UPDATE ON revision_calibrated BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER revision_calibrated_no_delete BEFORE DELETE ON revision_calibrated BEGIN SELECT RAISE(ABORT, 'append-only'); END;
