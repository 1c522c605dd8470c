-- How many sessions and edges each robot has, kept as they come: what is asked with every summary must not count a history.

CREATE TABLE summary_arrivals (
  robot_id TEXT NOT NULL PRIMARY KEY REFERENCES robot,
  sessions INTEGER NOT NULL,
  edges INTEGER NOT NULL                     -- that count
) STRICT, WITHOUT ROWID;

INSERT INTO summary_arrivals
SELECT robot_id, (SELECT count(*) FROM session s WHERE s.robot_id = r.robot_id),
       (SELECT count(*) FROM counted_edge c WHERE c.robot_id = r.robot_id) FROM robot r;

CREATE TRIGGER robot_arrives AFTER INSERT ON robot
BEGIN INSERT INTO summary_arrivals VALUES (new.robot_id, 0, 0); END;

CREATE TRIGGER session_arrives AFTER INSERT ON session
BEGIN UPDATE summary_arrivals SET sessions = sessions + 1 WHERE robot_id = new.robot_id; END;

CREATE TRIGGER counted_edge_arrives AFTER INSERT ON counted_edge
BEGIN UPDATE summary_arrivals SET edges = edges + 1 WHERE robot_id = new.robot_id; END;
