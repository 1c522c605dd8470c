-- Blobs may be in a bucket of an S3 service, and the folder is a copy of a part of them.

CREATE TABLE lease_bucket (                  -- of a store whose blobs are in one
  place TEXT PRIMARY KEY,                    -- "s3://BUCKET/PREFIX"
  store_id TEXT NOT NULL                     -- the bucket has it too, in the object rigcal-store (s3/store_bucket.h)
) STRICT, WITHOUT ROWID;
