-- What SQLite has and PostgreSQL has not, or has otherwise, as far as the schema and the queries of storage/ use it. Everything of a
-- store is in the schema rigcal, which is searched before PostgreSQL's own.

CREATE SCHEMA rigcal;

CREATE DOMAIN rigcal.bytewise AS text COLLATE "C";  -- in the order of its bytes

-- '$.tags[0]' as PostgreSQL has it: {tags,0}.
CREATE FUNCTION rigcal.json_steps(path text) RETURNS text[] LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT string_to_array(regexp_replace(pg_catalog.substr(path, 3), '\[(\d+)\]', '.\1', 'g'), '.') $$;

-- Of a JSON text: what stands at the path, a text without its quotes; NULL: nothing.
CREATE FUNCTION rigcal.json_extract(document text, path text) RETURNS text LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT document::json #>> rigcal.json_steps(path) $$;

-- The elements of a list, in order.
CREATE FUNCTION rigcal.json_each(list text) RETURNS TABLE (key bigint, value rigcal.bytewise) LANGUAGE sql IMMUTABLE STRICT ROWS 20 AS
$$ SELECT place - 1, element FROM json_array_elements_text(list::json) WITH ORDINALITY AS e (element, place) $$;
CREATE FUNCTION rigcal.json_each(document text, path text) RETURNS TABLE (key bigint, value rigcal.bytewise)
LANGUAGE sql IMMUTABLE STRICT ROWS 20 AS
$$ SELECT place - 1, element
   FROM json_array_elements_text(document::json #> rigcal.json_steps(path)) WITH ORDINALITY AS e (element, place) $$;

CREATE FUNCTION rigcal.instr(whole text, part text) RETURNS integer LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT strpos(whole, part) $$;
-- A length below zero is none.
CREATE FUNCTION rigcal.substr(whole text, first integer, length integer) RETURNS text LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT pg_catalog.substr(whole, first, greatest(length, 0)) $$;

-- The least and the greatest of some values; NULL where one of them is.
CREATE FUNCTION rigcal.min(a bigint, b bigint) RETURNS bigint LANGUAGE sql IMMUTABLE STRICT AS $$ SELECT least(a, b) $$;
CREATE FUNCTION rigcal.min(a double precision, b double precision) RETURNS double precision LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT least(a, b) $$;
CREATE FUNCTION rigcal.max(a bigint, b bigint) RETURNS bigint LANGUAGE sql IMMUTABLE STRICT AS $$ SELECT greatest(a, b) $$;
CREATE FUNCTION rigcal.max(a bigint, b bigint, c bigint) RETURNS bigint LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT greatest(a, b, c) $$;

-- How many of some conditions hold: (a IS NULL) + (b IS NULL) + (c IS NULL).
CREATE FUNCTION rigcal.count_true(a boolean, b boolean) RETURNS integer LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT a::integer + b::integer $$;
CREATE FUNCTION rigcal.count_true(a integer, b boolean) RETURNS integer LANGUAGE sql IMMUTABLE STRICT AS
$$ SELECT a + b::integer $$;
CREATE OPERATOR rigcal.+ (LEFTARG = boolean, RIGHTARG = boolean, FUNCTION = rigcal.count_true);
CREATE OPERATOR rigcal.+ (LEFTARG = integer, RIGHTARG = boolean, FUNCTION = rigcal.count_true);

CREATE TABLE rigcal.schema_version (version integer NOT NULL);  -- one row: how many files of storage/schema there are
INSERT INTO rigcal.schema_version VALUES (0);
