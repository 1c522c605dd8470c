-- Pairs of lidars that say too little to be held against better edges are merged apart from these, and stay known as such.

CREATE TABLE merged_edge_weak (              -- rows of merged_edge, of sessions, whose edges are weak
  robot_id TEXT NOT NULL,
  revision_number INTEGER NOT NULL,
  frame_a TEXT NOT NULL,
  frame_b TEXT NOT NULL,
  method TEXT NOT NULL,
  PRIMARY KEY (robot_id, revision_number, frame_a, frame_b, method),
  FOREIGN KEY (robot_id, revision_number) REFERENCES revision
) STRICT, WITHOUT ROWID;
CREATE TRIGGER merged_edge_weak_no_update BEFORE UPDATE ON merged_edge_weak BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER merged_edge_weak_no_delete BEFORE DELETE ON merged_edge_weak BEGIN SELECT RAISE(ABORT, 'append-only'); END;

-- Robots that have some in a merged edge.
INSERT INTO waiting_merge_anew
  SELECT DISTINCT c.robot_id FROM counted_edge c JOIN edge e ON e.number = c.edge_number
    LEFT JOIN edge_figure f ON f.edge_number = e.number AND f.name = 'overlap_ratio'
  WHERE e.state = 'good' AND e.session_id IS NOT NULL AND e.method = 'lidar_lidar' AND (e.rank < 6 OR f.value < 0.4)
    AND NOT EXISTS (SELECT 1 FROM waiting_merge w WHERE w.robot_id = c.robot_id AND w.edge_number = c.edge_number)
    AND NOT EXISTS (SELECT 1 FROM waiting_merge_anew a WHERE a.robot_id = c.robot_id);
