-- Boards as reference standards: what people measured of them, and which sessions used which.

CREATE TABLE board_measure (                 -- of each serial the newest holds
  number INTEGER PRIMARY KEY,                -- order of arrival among those of all boards
  serial TEXT NOT NULL CHECK (serial <> ''),
  kind TEXT NOT NULL CHECK (kind IN ('checkerboard', 'charuco', 'aruco_grid', 'april_grid')),
  col_count INTEGER NOT NULL CHECK (col_count > 0),  -- inner corners or tags, as row_count
  row_count INTEGER NOT NULL CHECK (row_count > 0),
  square_m REAL NOT NULL CHECK (square_m > 0),       -- side of a square (of a grid: of a tag) as it was to be printed
  length_x_m REAL NOT NULL CHECK (length_x_m > 0),   -- what was measured, as it was to be
  length_y_m REAL NOT NULL CHECK (length_y_m > 0),
  measured_x_m REAL NOT NULL CHECK (measured_x_m > 0),
  measured_y_m REAL NOT NULL CHECK (measured_y_m > 0),
  sigma_m REAL NOT NULL CHECK (sigma_m > 0),         -- of each of the two readings
  sigma_is_assumed INTEGER NOT NULL CHECK (sigma_is_assumed IN (0, 1)),
  flatness_m REAL,                           -- NULL: not measured
  next_check_ns INTEGER,                     -- NULL: nobody set one
  at_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  reason TEXT NOT NULL
) STRICT;
CREATE INDEX board_measure_of_serial ON board_measure (serial, number);

CREATE TRIGGER board_measure_no_update BEFORE UPDATE ON board_measure BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER board_measure_no_delete BEFORE DELETE ON board_measure BEGIN SELECT RAISE(ABORT, 'append-only'); END;

CREATE TABLE session_board (                 -- the targets of each closed session, as its manifest has them
  session_number INTEGER NOT NULL REFERENCES session,
  target_id TEXT NOT NULL,
  serial TEXT NOT NULL,                      -- empty: none
  kind TEXT NOT NULL,
  col_count INTEGER NOT NULL,
  row_count INTEGER NOT NULL,
  square_m REAL NOT NULL,
  square_sigma_m REAL NOT NULL,              -- 0: taken as exact
  PRIMARY KEY (session_number, target_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX session_board_of_serial ON session_board (serial, session_number) WHERE serial <> '';

INSERT INTO session_board
  SELECT session.number, json_extract(t.value, '$.id'), coalesce(json_extract(t.value, '$.serial'), ''), json_extract(t.value, '$.type'),
         coalesce(json_extract(t.value, '$.inner_corners[0]'), json_extract(t.value, '$.tags[0]')),
         coalesce(json_extract(t.value, '$.inner_corners[1]'), json_extract(t.value, '$.tags[1]')),
         json_extract(t.value, '$.square_size_m'), coalesce(json_extract(t.value, '$.square_size_sigma_m'), 0.0)
  FROM session JOIN session_closed ON session_closed.session_number = session.number, json_each(session.manifest, '$.targets') AS t;

CREATE TRIGGER session_board_no_update BEFORE UPDATE ON session_board BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER session_board_no_delete BEFORE DELETE ON session_board BEGIN SELECT RAISE(ABORT, 'append-only'); END;
