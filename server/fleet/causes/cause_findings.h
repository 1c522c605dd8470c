// What root causes make of a verdict.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "server/fleet/causes/root_causes.h"

namespace rigcal::fleet {

// Of those that `is_so`, in their order.
template <typename IsSo>
[[nodiscard]] std::vector<Finding> FindingsOf(const std::vector<RootCause>& causes, const IsSo& is_so) {
  std::vector<Finding> findings;
  for (const RootCause& cause : causes)
    if (is_so(cause)) findings.push_back(FindingOf(cause));
  return findings;
}

// Nothing at all was calibrated: the causes, or that it is so. Empty: something was.
[[nodiscard]] std::vector<Finding> FindNothing(const std::vector<Edge>& edges, const SessionTimes& captured_at,
                                               const std::vector<RootCause>& causes);
// Sensors that are exchanged; of those that edges disagree `around` also who is far from where the drawing has it, or
// may be exchanged.
[[nodiscard]] std::vector<Finding> FindMisplaced(const std::vector<RootCause>& causes,
                                                 const std::set<SensorId>& around);
// Of those that edges disagree `around` who is nearer to the drawing than is asked of it, yet not where it would be if
// the drawing were exact. Those that `causes` tell of are left out.
[[nodiscard]] std::optional<Finding> FindOffNominal(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                    const SessionHeaders& headers, const std::vector<RootCause>& causes,
                                                    const std::set<SensorId>& around);
// Why sensors have no whole pose: the causes of failures, each with the sensors that are lost to it, those that put a
// sensor known in part elsewhere, and what no cause explains. Empty: all have one.
[[nodiscard]] std::vector<Finding> FindUnknown(const std::vector<Edge>& edges, const GraphSolution& solution,
                                               const SessionHeaders& headers, const std::vector<RootCause>& causes);
// Causes that leave sensors a pose which is not to be relied on.
[[nodiscard]] std::vector<Finding> FindDoubted(const std::vector<RootCause>& causes);
// These sensors, and those far from the drawing: that alone is a warning, but where others are not to be relied on,
// they are not either.
[[nodiscard]] std::set<SensorId> DoubtedBy(const std::vector<RootCause>& causes);
[[nodiscard]] std::vector<const Edge*> UnexplainedFailures(const std::vector<Edge>& edges,
                                                           const SessionTimes& captured_at,
                                                           const std::vector<RootCause>& causes);

}  // namespace rigcal::fleet
