#include "server/report/cameras/camera_choice.h"

#include <algorithm>
#include <tuple>

#include "server/formats/edges/camera_fit.h"

namespace rigcal::report {
namespace {

std::int64_t TimeOf(const Edge& edge, const std::map<SessionId, Stamp>& captured_at) {
  const auto found = captured_at.find(edge.session);
  return found == captured_at.end() ? 0 : found->second.ns;
}

std::ptrdiff_t UsedOf(const Edge& edge) {
  return std::count_if(edge.captures.begin(), edge.captures.end(), [](const auto& capture) { return capture.used; });
}

bool IsGone(const SensorId& sensor, const formats::RevisionInput& revision) {
  return std::any_of(revision.retired.begin(), revision.retired.end(),
                     [&](const RetiredSensor& gone) { return gone.sensor == sensor; });
}

}  // namespace

std::vector<FitChoice> ChooseFits(const formats::RevisionInput& revision,
                                  const std::map<SessionId, Stamp>& captured_at) {
  using Rank = std::tuple<bool, std::int64_t, std::ptrdiff_t>;
  std::map<SensorId, std::pair<Rank, FitChoice>> best;
  for (const Edge& edge : revision.edges)
    for (const Evidence& evidence : edge.evidence) {
      if (evidence.suffix != formats::kCameraFitSuffix || IsGone(evidence.sensor, revision)) continue;
      const Rank rank{edge.state == EdgeState::kGood, TimeOf(edge, captured_at), UsedOf(edge)};
      const auto [at, fresh] =
          best.try_emplace(evidence.sensor, rank, FitChoice{evidence.sensor, edge.id, evidence.digest});
      if (!fresh && rank > at->second.first) at->second = {rank, {evidence.sensor, edge.id, evidence.digest}};
    }
  std::vector<FitChoice> choices;
  for (auto& [camera, choice] : best) choices.push_back(std::move(choice.second));
  return choices;
}

}  // namespace rigcal::report
