-- Files are put into a bucket outside of any transaction: who has the rows learns first that they are on their way.

CREATE TABLE lease_bucket_begun (            -- until all of the folder is in the bucket: then lease_bucket has the row
  place TEXT PRIMARY KEY,                    -- "s3://BUCKET/PREFIX"
  store_id TEXT NOT NULL                     -- what the bucket's object rigcal-store says, or will say
) STRICT, WITHOUT ROWID;
