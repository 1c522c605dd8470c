-- Robots whose newest edge or newest word about what counts is in no revision yet: found without looking at all robots.

CREATE TABLE waiting_revision (
  robot_id TEXT NOT NULL PRIMARY KEY REFERENCES robot
) STRICT, WITHOUT ROWID;

CREATE TRIGGER counted_edge_waits AFTER INSERT ON counted_edge
BEGIN INSERT OR IGNORE INTO waiting_revision VALUES (new.robot_id); END;

CREATE TRIGGER standing_waits AFTER INSERT ON standing
WHEN EXISTS (SELECT 1 FROM counted_edge WHERE robot_id = new.robot_id)
BEGIN INSERT OR IGNORE INTO waiting_revision VALUES (new.robot_id); END;

INSERT INTO waiting_revision
SELECT robot_id FROM robot r
WHERE (SELECT max(number) FROM counted_edge c WHERE c.robot_id = r.robot_id) >
      coalesce((SELECT edge_watermark FROM revision v WHERE v.robot_id = r.robot_id ORDER BY v.number DESC LIMIT 1), 0)
   OR (EXISTS (SELECT 1 FROM counted_edge e WHERE e.robot_id = r.robot_id) AND
       (SELECT max(number) FROM standing t WHERE t.robot_id = r.robot_id) >
       coalesce((SELECT standing_watermark FROM revision_standing s WHERE s.robot_id = r.robot_id
                 ORDER BY s.revision_number DESC LIMIT 1), 0));
