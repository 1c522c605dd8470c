#include "server/model/sessions/session_estimate.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <span>

namespace rigcal {
namespace {

template <typename Row>
void MoveAll(std::vector<Row>& from, std::vector<Row>& to) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  from.clear();
}

// The parts of one session.
void TellTogether(std::span<SessionEstimate> parts) {
  const auto refined = std::find_if(parts.begin(), parts.end(), [](const auto& part) { return part.why_not.empty(); });
  for (SessionEstimate& part : parts) {
    if (&part != &parts.front()) MoveAll(part.moved, parts.front().moved);
    if (refined == parts.end() || !part.why_not.empty() || &part == &*refined) continue;
    MoveAll(part.boards_moved, refined->boards_moved);
    MoveAll(part.held_back, refined->held_back);
    MoveAll(part.misfits, refined->misfits);
    MoveAll(part.slants, refined->slants);
    MoveAll(part.pupil_shifts, refined->pupil_shifts);
    MoveAll(part.bends, refined->bends);
    MoveAll(part.stretches, refined->stretches);
    MoveAll(part.contradicted_lenses, refined->contradicted_lenses);
    MoveAll(part.look_scatter, refined->look_scatter);
    MoveAll(part.clocks, refined->clocks);
    MoveAll(part.late, refined->late);
    MoveAll(part.lost_sights, refined->lost_sights);
    MoveAll(part.contradicted, refined->contradicted);
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
