-- Merged edges are made from all edges of the robot where more visits are to stay as they are, and where an older version made
-- them otherwise.

CREATE TABLE merge_state_window (            -- of the robot's newest revision; without a row: 8
  robot_id TEXT NOT NULL PRIMARY KEY REFERENCES robot,
  visits_in_full INTEGER NOT NULL CHECK (visits_in_full > 0)
) STRICT, WITHOUT ROWID;

CREATE TABLE waiting_merge_anew (            -- robots whose merged edges an older version made otherwise
  robot_id TEXT NOT NULL PRIMARY KEY REFERENCES robot
) STRICT, WITHOUT ROWID;

-- The sum of two edges that leave a direction open knew a little of it, as noise turns it, though neither measured it.
INSERT INTO waiting_merge_anew
  SELECT DISTINCT robot_id FROM (
    SELECT c.robot_id FROM counted_edge c JOIN edge e ON e.number = c.edge_number
    WHERE e.state = 'good' AND e.rank < 6
      AND EXISTS (SELECT 1 FROM merged_edge m WHERE m.robot_id = c.robot_id AND m.frame_a = e.frame_a
                  AND m.frame_b = e.frame_b AND m.method = e.method)
      AND NOT EXISTS (SELECT 1 FROM waiting_merge w WHERE w.robot_id = c.robot_id AND w.edge_number = c.edge_number)
    GROUP BY c.robot_id, e.frame_a, e.frame_b, e.method HAVING count(*) > 1) invented;
