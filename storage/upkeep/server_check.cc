// What a store in PostgreSQL cannot be asked page by page: whether that server does it, and references between rows.
#include "storage/database/query.h"
#include "storage/upkeep/fsck.h"

namespace rigcal::storage {
namespace {

// One query per reference, which finds a row whose other one is not there. PostgreSQL holds to them when rows are
// written, not once they lie on the disk.
constexpr const char* kReferences = R"(
  SELECT child.relname::text, parent.relname::text,
    'SELECT 1 FROM ' || f.conrelid::regclass || ' c WHERE ' ||
    string_agg(format('c.%I IS NOT NULL', a.attname), ' AND ' ORDER BY k.place) ||
    ' AND NOT EXISTS (SELECT 1 FROM ' || f.confrelid::regclass || ' p WHERE ' ||
    string_agg(format('p.%I = c.%I', b.attname, a.attname), ' AND ' ORDER BY k.place) || ') LIMIT 1'
  FROM pg_constraint f
  JOIN pg_class child ON child.oid = f.conrelid
  JOIN pg_class parent ON parent.oid = f.confrelid,
  LATERAL unnest(f.conkey, f.confkey) WITH ORDINALITY k(of_child, of_parent, place),
  pg_attribute a, pg_attribute b
  WHERE f.contype = 'f' AND f.connamespace = to_regnamespace('rigcal')
    AND a.attrelid = f.conrelid AND a.attnum = k.of_child AND b.attrelid = f.confrelid AND b.attnum = k.of_parent
  GROUP BY f.oid, f.conrelid, f.confrelid, child.relname, parent.relname
  ORDER BY child.relname, parent.relname, f.oid)";

struct Reference {
  std::string child, parent, search;
};

void AddError(const Status& looked, FsckDone& done) {
  if (!looked) done.findings.push_back({Finding::Kind::kRow, looked.error().what, looked.error().cure});
}

Finding OfSums(bool are_on) {
  if (are_on)
    return {Finding::Kind::kPage,
            "PostgreSQL holds each page of its database to a checksum when it reads it (data_checksums is on)",
            "Nothing is to be done: `pg_amcheck` reads all of them.", false};
  return {Finding::Kind::kPage,
          "PostgreSQL does not see what the disk changes within its pages (data_checksums is off)",
          "Stop it, run `pg_checksums --enable`, and start it again.", false};
}

Status CheckSums(Store& store, FsckDone& done) {
  Query query(store, "SELECT current_setting('data_checksums') = 'on'");
  if (query.Step()) done.findings.push_back(OfSums(query.Int(0) != 0));
  return {};
}

std::vector<Reference> ReferencesOf(Store& store) {
  std::vector<Reference> references;
  Query query(store, kReferences);
  while (query.Step()) references.push_back({query.Text(0), query.Text(1), query.Text(2)});
  return references;
}

Status CheckReferences(Store& store, FsckDone& done) {
  for (const Reference& one : ReferencesOf(store)) {
    if (!Query(store, one.search).Step()) continue;
    done.findings.push_back(
        {Finding::Kind::kRow,
         "a row of the table " + one.child + " refers to one of " + one.parent + " that is not there",
         "Restore the newest backup of PostgreSQL from before (`pg_restore`, pgBackRest) and push "
         "again what came since: nothing is stored twice."});
  }
  return {};
}

}  // namespace

void CheckServer(Store& store, FsckDone& done) {
  const auto look = [&](const std::function<Status(Store&, FsckDone&)>& check) {
    AddError(store.Read([&] { return store.connection().Load("the database", [&] { return check(store, done); }); }),
             done);
  };
  look(CheckSums);
  look(CheckReferences);
}

}  // namespace rigcal::storage
