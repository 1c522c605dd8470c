// The document about a re-computation of stored sessions (docs/api.md, recomputation).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/approval/decision.h"
#include "server/model/sessions/recomputation.h"

namespace rigcal::formats {

struct RecomputedRobotRow {
  RecomputedRobot done;
  RevisionState state = RevisionState::kUnusable;  // of its candidate, now
  std::string verdict;                             // likewise
};

// order resolve, verb recomputation
struct RecomputationAnswer {
  RecomputationRun run;
  RecomputationProgress progress;
  std::vector<RecomputedRobotRow> robots;  // that are done, the largest effect first
  std::vector<SessionLeft> left;           // sessions that were kept or failed
  std::optional<bool> is_new = {};         // of the order: false where that run was there already
};
// Lists as they are; what they leave out is told by the counts.
[[nodiscard]] std::string WriteRecomputation(const RecomputationAnswer& answer);

}  // namespace rigcal::formats
