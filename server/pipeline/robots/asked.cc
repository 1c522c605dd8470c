#include "server/pipeline/robots/asked.h"

#include <limits>

#include "server/base/limits.h"
#include "server/pipeline/robots/unknown_names.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {

Result<RobotId> KnownRobot(storage::Store& store, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, RequiredId<RobotId>(parameters, "robot"));
  RIGCAL_ASSIGN(const bool is_known, storage::HasRobot(store, robot));
  if (is_known) return robot;
  return Fail(UnknownRobot(store, robot));
}

Result<std::int64_t> PageRows(const formats::Parameters& parameters) {
  if (!parameters.Text("limit")) return parameters.Text("before") ? limits::kPageRowsMax : 0;
  RIGCAL_ASSIGN(const std::int64_t limit, parameters.IntegerOr("limit", 0));
  if (limit >= 1 && limit <= limits::kPageRowsMax) return limit;
  return Fail(ErrorCode::kInvalidInput, "the parameter 'limit' is " + std::to_string(limit),
              "Ask for 1 to " + std::to_string(limits::kPageRowsMax) + " rows at once.");
}

Result<int> RevisionBefore(const formats::Parameters& parameters) {
  if (!parameters.Text("before")) return 0;
  RIGCAL_ASSIGN(const std::int64_t before, parameters.IntegerOr("before", 0));
  if (before >= 1 && before <= std::numeric_limits<int>::max()) return static_cast<int>(before);
  return Fail(ErrorCode::kInvalidInput, "the parameter 'before' is " + std::to_string(before),
              "Give the number of a revision.");
}

}  // namespace rigcal::pipeline
