#include "server/graph/fusion/visit_ages.h"

#include <algorithm>
#include <optional>

namespace rigcal::graph {
namespace {

constexpr double kDay_ns = 86'400e9;

double DaysBetween(Stamp older, Stamp newer) {
  return std::clamp(static_cast<double>(newer.ns - older.ns) / kDay_ns, 0.0, kWalkedDaysMax);
}

struct DatedFactor {
  Stamp at;
  double age_days = 0.0;
};

// Those that have dates, the newest first; each no newer than the one before it.
std::vector<DatedFactor> TakeAgesOfSessions(const VisitDates& dates, SessionFusion& fusion) {
  std::vector<DatedFactor> dated;
  for (SessionFactor& factor : fusion.factors) {
    const auto at = dates.sessions.find(factor.session);
    if (at != dates.sessions.end() && dated.empty()) dated.push_back({at->second, 0.0});
    if (at != dates.sessions.end() && at->second < dated.back().at)
      dated.push_back({at->second, dated.back().age_days + DaysBetween(at->second, dated.back().at)});
    factor.age_days = dated.empty() ? 0.0 : dated.back().age_days;
  }
  return dated;
}

}  // namespace

void TakeAges(const VisitDates& dates, SessionFusion& fusion) {
  const std::vector<DatedFactor> sessions = TakeAgesOfSessions(dates, fusion);
  for (EdgeFactor& edge : fusion.edges) {
    const auto at = dates.edges.find(edge.edge);
    if (at == dates.edges.end()) continue;
    for (const DatedFactor& session : sessions)  // the oldest that is not older goes last
      if (at->second <= session.at) edge.age_days = session.age_days + DaysBetween(at->second, session.at);
  }
}

double DaysUntilNext(const SessionFusion& fusion) {
  double newest = 0.0, oldest = 0.0;
  for (const SessionFactor& factor : fusion.factors) {
    oldest = std::max(oldest, factor.age_days);
    if (factor.age_days > 0 && !(newest > 0)) newest = factor.age_days;
  }
  const auto visits = static_cast<double>(fusion.sessions.size());
  return visits > 1 ? std::max(newest, oldest / (visits - 1)) : 0.0;
}

}  // namespace rigcal::graph
