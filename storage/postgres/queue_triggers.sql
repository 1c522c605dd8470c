-- Whoever listens to a queue (store_changes.h) is told that something was put in it. Made for each that has no such trigger yet, after
-- a migration.

CREATE OR REPLACE FUNCTION rigcal.tell_of_rows() RETURNS trigger LANGUAGE plpgsql AS
$$ BEGIN PERFORM pg_notify(TG_TABLE_NAME, ''); RETURN NULL; END $$;

DO $$
DECLARE queue text;
BEGIN
  FOR queue IN
    SELECT tablename FROM pg_tables t WHERE schemaname = 'rigcal' AND tablename LIKE 'waiting\_%'
    AND NOT EXISTS (SELECT 1 FROM pg_trigger g WHERE g.tgname = t.tablename || '_told')
  LOOP
    EXECUTE format('CREATE TRIGGER %I AFTER INSERT ON rigcal.%I FOR EACH STATEMENT EXECUTE FUNCTION rigcal.tell_of_rows()',
                   queue || '_told', queue);
  END LOOP;
END $$;
