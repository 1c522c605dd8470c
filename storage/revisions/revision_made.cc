#include "storage/revisions/revision_made.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string MakingOf(const RevisionKey& key) {
  return "how revision " + std::to_string(key.number) + " of robot " + key.robot.str() + " was made";
}

}  // namespace

Status AppendRevisionMade(Store& store, const RevisionKey& key, const RevisionMade& made) {
  return store.connection().Append(MakingOf(key), [&]() -> Status {
    Query(store, "INSERT INTO revision_made VALUES (?, ?, ?, ?)")
        .Bind(key.robot, key.number, made.software, made.in_use)
        .Run();
    return {};
  });
}

Result<std::optional<RevisionMade>> LoadRevisionMade(Store& store, const RevisionKey& key) {
  using Made = std::optional<RevisionMade>;
  return Load<Made>(store, MakingOf(key), [&]() -> Result<Made> {
    Query row(store, "SELECT software, in_use FROM revision_made WHERE robot_id = ? AND revision_number = ?");
    if (!row.Bind(key.robot, key.number).Step()) return std::nullopt;
    RevisionMade made{row.Text(0), std::nullopt};
    if (!row.IsNull(1)) made.in_use = static_cast<int>(row.Int(1));
    return made;
  });
}

}  // namespace rigcal::storage
