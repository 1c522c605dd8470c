-- How much of an edge's covariance its blocks made; the rest is the model's. NULL or 0: not told.

ALTER TABLE edge ADD COLUMN jackknife_ratio REAL CHECK (jackknife_ratio BETWEEN 0 AND 1);
