-- Robots are revised in the order in which they began to wait, not in that of their names: then none waits for ever behind others that
-- bring edges without a pause.

ALTER TABLE waiting_revision ADD COLUMN since INTEGER NOT NULL DEFAULT 0;  -- number of its first edge that waits, of a word: of the newest edge then
CREATE INDEX waiting_revision_in_turn ON waiting_revision (since, robot_id);

DROP TRIGGER counted_edge_waits;
CREATE TRIGGER counted_edge_waits AFTER INSERT ON counted_edge
BEGIN INSERT OR IGNORE INTO waiting_revision VALUES (new.robot_id, new.number); END;

DROP TRIGGER standing_waits;
CREATE TRIGGER standing_waits AFTER INSERT ON standing
WHEN EXISTS (SELECT 1 FROM counted_edge WHERE robot_id = new.robot_id)
BEGIN INSERT OR IGNORE INTO waiting_revision SELECT new.robot_id, coalesce(max(number), 0) FROM counted_edge; END;
