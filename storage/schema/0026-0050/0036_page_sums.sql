-- No table: from this version on a sum of every page is noted beside the database as it is written (database/page_sums.h). A rigcald
-- of before would write pages and leave their old sums, which then looks like damage: so it must not open this store.
SELECT 1;
