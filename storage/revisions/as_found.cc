#include "storage/revisions/as_found.h"

#include "server/formats/revision/as_found.h"
#include "storage/database/compressed.h"
#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kAsFoundTextMax = 64u << 20;
constexpr char kBetweenDrifted = '/';  // is in no id

std::string AsFoundSubject(const RevisionKey& key) {
  return "what the newest session of revision " + std::to_string(key.number) + " of robot " + key.robot.str() +
         " found";
}

std::string JoinedIds(const std::vector<SensorId>& sensors) {
  std::string joined;
  for (const SensorId& sensor : sensors)
    joined += (joined.empty() ? "" : std::string(1, kBetweenDrifted)) + sensor.str();
  return joined;
}

std::vector<SensorId> SplitIds(const std::string& joined) {
  std::vector<SensorId> sensors;
  for (std::size_t first = 0; first < joined.size();) {
    const std::size_t end = std::min(joined.find(kBetweenDrifted, first), joined.size());
    sensors.emplace_back(joined.substr(first, end - first));
    first = end + 1;
  }
  return sensors;
}

}  // namespace

Status AppendAsFound(Store& store, const RevisionKey& key, const AsFound& found) {
  return store.connection().Append(AsFoundSubject(key), [&]() -> Status {
    const std::string document = formats::WriteAsFound(found);
    RIGCAL_TRY(formats::ReadAsFound(document));  // no number that is none, no name that is empty
    RIGCAL_ASSIGN(std::string zstd, Compress(AsFoundSubject(key), document, kAsFoundTextMax));
    const AsFoundSummary summary = SummaryOf(found);
    Query(store, "INSERT INTO revision_as_found VALUES (?, ?, ?, ?, ?, ?)")
        .Bind(key.robot, key.number, summary.session, NameOf(summary.state), JoinedIds(summary.drifted),
              Blob{std::move(zstd)})
        .Run();
    return {};
  });
}

Result<std::optional<AsFound>> LoadAsFound(Store& store, const RevisionKey& key) {
  using Found = std::optional<AsFound>;
  return Load<Found>(store, AsFoundSubject(key), [&]() -> Result<Found> {
    Query query(store, "SELECT zstd FROM revision_as_found WHERE robot_id = ? AND revision_number = ?");
    if (!query.Bind(key.robot, key.number).Step()) return std::nullopt;
    RIGCAL_ASSIGN(const std::string document, Decompress(AsFoundSubject(key), query.Text(0), kAsFoundTextMax));
    RIGCAL_ASSIGN(AsFound found, formats::ReadAsFound(document));
    return found;
  });
}

Result<std::map<int, AsFoundSummary>> LoadAsFoundSummaries(Store& store, const RobotId& robot,
                                                           const std::vector<int>& numbers) {
  using Summaries = std::map<int, AsFoundSummary>;
  return Load<Summaries>(store, "what sessions of robot " + robot.str() + " found", [&]() -> Result<Summaries> {
    Query query(store,
                "SELECT revision_number, session_id, state, drifted FROM revision_as_found WHERE robot_id = ? AND "
                "revision_number IN (SELECT CAST(value AS BIGINT) FROM json_each(?))");
    query.Bind(robot, ListOf(numbers));
    Summaries summaries;
    while (query.Step()) {
      RIGCAL_ASSIGN(const FoundState state, FoundStateOf(query.Text(2)));
      summaries[static_cast<int>(query.Int(0))] = {query.IdAt<SessionId>(1), state, SplitIds(query.Text(3))};
    }
    return summaries;
  });
}

}  // namespace rigcal::storage
