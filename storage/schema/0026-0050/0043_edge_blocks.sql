-- All block vectors of an edge in one row: an insert an edge, where edge_block takes one a block. Edges from before keep their rows there.

CREATE TABLE edge_blocks (
  edge_number INTEGER PRIMARY KEY REFERENCES edge,
  block_ids TEXT NOT NULL,                   -- one a line, in the order of d
  d BLOB NOT NULL CHECK (length(d) > 0 AND length(d) % 48 = 0)  -- 6 doubles a block: Log(T^-1 T_(i)), m and rad
) STRICT;
CREATE TRIGGER edge_blocks_no_update BEFORE UPDATE ON edge_blocks BEGIN SELECT RAISE(ABORT, 'append-only'); END;
CREATE TRIGGER edge_blocks_no_delete BEFORE DELETE ON edge_blocks BEGIN SELECT RAISE(ABORT, 'append-only'); END;
