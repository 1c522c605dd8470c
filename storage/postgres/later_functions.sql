-- What came to sqlite_functions.sql since there are stores: made in each store before a migration.

-- The time now, as the number of days since noon of 1 January of 4713 BC; of 'now' only.
CREATE OR REPLACE FUNCTION rigcal.julianday(moment text) RETURNS double precision LANGUAGE sql VOLATILE STRICT AS
$$ SELECT extract(epoch FROM clock_timestamp())::double precision / 86400 + 2440587.5 $$;
