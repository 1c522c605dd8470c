-- The edges that count, in the order in which they began to. An edge of a batch counts when its whole batch is stored;
-- all others at once. edge_watermark of a revision is the newest number of this table that it contains.

CREATE TABLE counted_edge (
  number INTEGER PRIMARY KEY,
  edge_number INTEGER NOT NULL UNIQUE REFERENCES edge,
  robot_id TEXT NOT NULL REFERENCES robot
) STRICT;
CREATE INDEX counted_edge_of_robot ON counted_edge (robot_id);

CREATE TRIGGER counted_edge_no_update BEFORE UPDATE ON counted_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER counted_edge_no_delete BEFORE DELETE ON counted_edge BEGIN SELECT RAISE(ABORT, 'append-only'); END;

-- A store from before: all count, but what came in incomplete batches only and is in no revision yet. The numbers are
-- those of the edges, which watermarks of older revisions mean.
INSERT INTO counted_edge
SELECT number, number, robot_id FROM edge e
WHERE number NOT IN (
    SELECT edge_number FROM batch_item WHERE batch_number IN (SELECT batch_number FROM waiting_batch)
    EXCEPT
    SELECT edge_number FROM batch_item WHERE batch_number NOT IN (SELECT batch_number FROM waiting_batch))
  OR number <= (SELECT edge_watermark FROM revision v WHERE v.robot_id = e.robot_id ORDER BY v.number DESC LIMIT 1)
ORDER BY number;
