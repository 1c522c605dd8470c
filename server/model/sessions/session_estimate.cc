#include "server/model/sessions/session_estimate.h"

#include <algorithm>
#include <set>
#include <span>

namespace rigcal {
namespace {

// From one part of a session to another.
template <typename... Lists>
void MoveLists(SessionEstimate& from, SessionEstimate& to, Lists... lists) {
  const auto move = [&](auto list) {
    (to.*list).insert((to.*list).end(), (from.*list).begin(), (from.*list).end());
    (from.*list).clear();
  };
  (move(lists), ...);
}

// The parts of one session.
void TellTogether(std::span<SessionEstimate> parts) {
  using Part = SessionEstimate;
  const auto refined = std::find_if(parts.begin(), parts.end(), [](const Part& part) { return part.why_not.empty(); });
  for (Part& part : parts) {
    if (&part != &parts.front()) MoveLists(part, parts.front(), &Part::moved);
    if (refined == parts.end() || !part.why_not.empty() || &part == &*refined) continue;
    MoveLists(part, *refined, &Part::boards_moved, &Part::held_back, &Part::misfits, &Part::slants, &Part::pupil_shifts,
              &Part::bends, &Part::stretches, &Part::contradicted_lenses, &Part::look_scatter, &Part::clocks,
              &Part::late, &Part::lost_sights, &Part::contradicted);
  }
}

}  // namespace

std::vector<LensMisfit> NewestMisfits(const std::vector<SessionEstimate>& estimates) {
  std::vector<LensMisfit> newest;
  std::set<SensorId> judged;
  for (const SessionEstimate& estimate : estimates) {
    if (!estimate.why_not.empty()) continue;
    for (const LensMisfit& misfit : estimate.misfits)
      if (!judged.contains(misfit.camera)) newest.push_back(misfit);
    for (const RefinedPose& pose : estimate.poses) judged.insert(pose.sensor);
  }
  return newest;
}

std::vector<SessionEstimate> IslandsApart(std::vector<SessionEstimate> estimates) {
  std::vector<SessionEstimate> apart;
  for (SessionEstimate& estimate : estimates) {
    const std::size_t first = apart.size();
    std::vector<SessionEstimate> islands = std::move(estimate.islands);
    estimate.islands.clear();
    apart.push_back(std::move(estimate));
    for (SessionEstimate& island : islands) {
      island.session = apart[first].session;
      island.made_by = apart[first].made_by;
      apart.push_back(std::move(island));
    }
    TellTogether({apart.begin() + static_cast<std::ptrdiff_t>(first), apart.end()});
  }
  return apart;
}

}  // namespace rigcal
