#include "storage/fleet/robot_runs.h"

#include "server/base/text.h"
#include "storage/database/query.h"
#include "storage/sessions/sessions.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kRunsWhoBytesMax = 64;

std::string RunsSubject(const RobotId& robot) { return "what robot " + robot.str() + " runs"; }

Status CheckRuns(Store& store, const RunsReport& report) {
  if (report.who.size() > kRunsWhoBytesMax || !IsPrintableUtf8(report.who))
    return Fail(ErrorCode::kInvalidInput,
                "who applied the calibration, " + Quoted(report.who) + ", is not one readable line",
                "Use at most " + std::to_string(kRunsWhoBytesMax) + " bytes of UTF-8 without control characters.");
  RIGCAL_ASSIGN(const bool is_known, HasRobot(store, report.robot));
  if (is_known) return {};
  return Fail(ErrorCode::kNotFound, "robot '" + report.robot.str() + "' is not known",
              "Push a session or edges of it first.");
}

// Of several alike the newest; 0: none.
int RevisionOfDigest(Store& store, const RobotId& robot, const Digest& digest) {
  Query query(store, "SELECT number FROM revision WHERE robot_id = ? AND digest = ? ORDER BY number DESC LIMIT 1");
  return query.Bind(robot, digest).Step() ? static_cast<int>(query.Int(0)) : 0;
}

std::optional<RobotRuns> NewestRuns(Store& store, const RobotId& robot) {
  Query query(store,
              "SELECT digest, applied_ns, who, revision_number, told_ns FROM robot_runs WHERE robot_id = ? "
              "ORDER BY number DESC LIMIT 1");
  if (!query.Bind(robot).Step()) return std::nullopt;
  return RobotRuns{
      {robot, query.IdAt<Digest>(0), query.Time(1), query.Text(2)}, static_cast<int>(query.Int(3)), query.Time(4)};
}

}  // namespace

Result<bool> AppendRuns(Store& store, const RunsReport& report, Stamp now) {
  return Append<bool>(store, RunsSubject(report.robot), [&]() -> Result<bool> {
    RIGCAL_TRY(CheckRuns(store, report));
    const auto newest = NewestRuns(store, report.robot);
    if (newest && newest->report.digest == report.digest) return false;
    Query(store,
          "INSERT INTO robot_runs (robot_id, digest, revision_number, applied_ns, told_ns, who) VALUES (?, ?, ?, ?, ?, "
          "?)")
        .Bind(report.robot, report.digest, RevisionOfDigest(store, report.robot, report.digest), report.applied_at, now,
              report.who)
        .Run();
    return true;
  });
}

Result<std::optional<RobotRuns>> LoadRuns(Store& store, const RobotId& robot) {
  using Found = std::optional<RobotRuns>;
  return Load<Found>(store, RunsSubject(robot), [&]() -> Result<Found> { return NewestRuns(store, robot); });
}

}  // namespace rigcal::storage
