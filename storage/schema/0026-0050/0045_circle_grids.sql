-- Grids of circles may be measured, too.

ALTER TABLE board_measure RENAME TO board_measure_41;

CREATE TABLE board_measure (                 -- of each serial the newest holds
  number INTEGER PRIMARY KEY,                -- order of arrival among those of all boards
  serial TEXT NOT NULL CHECK (serial <> ''),
  kind TEXT NOT NULL CHECK (kind IN ('checkerboard', 'charuco', 'aruco_grid', 'april_grid', 'circle_grid',
                                            'asymmetric_circle_grid')),
  col_count INTEGER NOT NULL CHECK (col_count > 0),  -- inner corners, tags or circles, as row_count
  row_count INTEGER NOT NULL CHECK (row_count > 0),
  square_m REAL NOT NULL CHECK (square_m > 0),       -- side of a square, of a tag, or spacing of circles, as it was to be printed
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
INSERT INTO board_measure
  SELECT number, serial, kind, col_count, row_count, square_m, length_x_m, length_y_m, measured_x_m, measured_y_m, sigma_m, sigma_is_assumed,
         flatness_m, next_check_ns, at_ns, who, reason FROM board_measure_41;
DROP TABLE board_measure_41;

CREATE INDEX board_measure_of_serial ON board_measure (serial, number);

CREATE TRIGGER board_measure_no_update BEFORE UPDATE ON board_measure BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER board_measure_no_delete BEFORE DELETE ON board_measure BEGIN SELECT RAISE(ABORT, 'append-only'); END;
