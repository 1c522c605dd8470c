// What the engine and the digests within rows say of a database.
#include <SQLiteCpp/SQLiteCpp.h>

#include "server/base/digests/sha256.h"
#include "storage/audit.h"
#include "storage/database/connection.h"
#include "storage/database/page_sums.h"
#include "storage/database/query.h"
#include "storage/files/folders.h"
#include "storage/revisions/revisions.h"
#include "storage/upkeep/fsck.h"
#include "storage/upkeep/page_check.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kNamedMax = 100;  // of one kind
constexpr const char* kRestoreIt =
    "Restore the newest backup from before (`rigcal restore-backup`) and push again what came since: nothing is stored "
    "twice.";

void Add(FsckDone& done, std::string what, const std::string& cure = kRestoreIt) {
  done.findings.push_back({Finding::Kind::kRow, std::move(what), cure});
}

// What cannot even be looked at is damage as well.
void Look(Store& store, FsckDone& done, const std::function<Status()>& body) {
  const Status looked = store.Read([&] { return store.connection().Load("the database", body); });
  if (!looked) Add(done, looked.error().what);
}

void CheckStructure(Store& store, FsckDone& done) {
  Look(store, done, [&]() -> Status {
    SQLite::Statement check(store.database(), "PRAGMA integrity_check(" + std::to_string(kNamedMax) + ")");
    while (check.executeStep())
      if (const std::string said = check.getColumn(0).getString(); said != "ok")
        Add(done, "SQLite says of rigcal.db: " + said);
    return {};
  });
}

void CheckReferences(Store& store, FsckDone& done) {
  Look(store, done, [&]() -> Status {
    SQLite::Statement check(store.database(), "PRAGMA foreign_key_check");
    for (std::size_t i = 0; i < kNamedMax && check.executeStep(); ++i)
      Add(done, "a row of the table " + check.getColumn(0).getString() + " refers to one of " +
                    check.getColumn(2).getString() + " that is not there");
    return {};
  });
}

void CheckManifests(Store& store, FsckDone& done) {
  Look(store, done, [&]() -> Status {
    Query query(store, "SELECT session_id, robot_id, manifest FROM session ORDER BY number");
    while (query.Step())
      if (Sha256Of(query.Text(2)).str() != query.Text(0))
        Add(done, "the manifest of session " + query.Text(0) + " of robot " + query.Text(1) +
                      " is not the one that was stored");
    return {};
  });
}

std::vector<RevisionKey> LoadKeys(Store& store, FsckDone& done) {
  std::vector<RevisionKey> keys;
  Look(store, done, [&]() -> Status {
    Query query(store, "SELECT robot_id, number FROM revision ORDER BY robot_id, number");
    while (query.Step()) keys.push_back({query.IdAt<RobotId>(0), static_cast<int>(query.Int(1))});
    return {};
  });
  return keys;
}

void CheckRevisions(Store& store, FsckDone& done) {
  for (const RevisionKey& key : LoadKeys(store, done)) {
    const auto revision = LoadRevision(store, key.robot, key.number);
    const std::string name = "revision " + std::to_string(key.number) + " of robot " + key.robot.str();
    if (!revision)
      Add(done, revision.error().what);
    else if (!*revision || Sha256Of((*revision)->document) != (*revision)->digest)
      Add(done, "the document of " + name + " is not the one that was stored");
  }
}

void CheckAudit(Store& store, FsckDone& done) {
  const auto check = VerifyAudit(store);
  if (!check) return Add(done, check.error().what);
  const std::string cure =
      "See `rigcal audit verify`; if nobody changed the database, restore the newest backup from before.";
  if (check->fault) Add(done, TextOf(*check->fault), cure);
  for (const AuditFault& fault : check->row_faults) Add(done, TextOf(fault), cure);
}

// Of a page that holds nothing, nothing can be lost. Where it belongs to a list of free pages that is broken, SQLite's
// own words follow.
Finding OfFreePage(std::string what, bool is_mended) {
  return {Finding::Kind::kPage, std::move(what),
          is_mended ? "It holds nothing, so that nothing is lost: it was noted as it is."
                    : "It holds nothing, so that nothing is lost: `rigcal fsck --repair` notes it as it is.",
          false, is_mended};
}

Finding OfPage(std::int64_t page, const PageOwner& owner, const Mended& mended) {
  std::string what =
      TextOfPage(page, owner) + " is not as rigcald wrote it: the disk, or another program, has changed it";
  if (owner.is_free) return OfFreePage(std::move(what), mended.free_pages);
  return {Finding::Kind::kPage, std::move(what), owner.is_index ? "`rigcal fsck --repair` makes it again." : kRestoreIt,
          true, owner.is_index && mended.all_others};
}

}  // namespace

void CheckPages(Store& store, const FsckOptions& options, FsckDone& done) {
  const auto file = DatabaseFile(store.folder());
  const auto look = LookAtPages(store.connection(), file);
  if (!look) return Add(done, look.error().what, look.error().cure);
  done.pages = look->pages;
  done.pages_unknown = look->unknown;
  if (look->damaged.empty()) return;
  const auto owners = OwnersOf(store.connection(), look->damaged);
  const auto mended = options.repair ? MendPages(store.connection(), file, look->damaged) : Result<Mended>(Mended{});
  for (const auto& [page, owner] : owners) done.findings.push_back(OfPage(page, owner, mended.value_or(Mended{})));
}

void CheckPages(const std::filesystem::path& database, FsckDone& done) {
  const auto look = LookAtPages(database);
  if (!look) return Add(done, look.error().what, look.error().cure);
  done.pages = look->pages;
  done.pages_unknown = look->unknown;
  for (const std::int64_t page : look->damaged) done.findings.push_back(OfPage(page, {}, {}));
}

void CheckRows(Store& store, FsckDone& done) {
  if (store.place().server.empty()) {
    CheckStructure(store, done);
    CheckReferences(store, done);
  } else {
    CheckServer(store, done);
  }
  CheckManifests(store, done);
  CheckRevisions(store, done);
  CheckAudit(store, done);
}

}  // namespace rigcal::storage
