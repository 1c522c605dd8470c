#include "client/moments/clocks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "client/moments/clock_fit.h"

namespace rigcal::moments {
namespace {

constexpr const char* kClockNames[] = {"reference", "stated", "estimated", "unknown"};

std::size_t FoundIn(const WatchedCamera& camera, int target_idx) {
  return static_cast<std::size_t>(std::count_if(camera.sights->begin(), camera.sights->end(), [&](const Sight& sight) {
    return target_idx < 0 ? sight.found() : sight.target_idx == target_idx;
  }));
}

// Of both cameras the index of the board that is seen most in the one that sees it less; -1: they share none.
struct CommonBoard {
  int idx_a = -1, idx_b = -1;
};
CommonBoard CommonBoardOf(const WatchedCamera& a, const WatchedCamera& b) {
  CommonBoard best;
  std::size_t most = 0;
  for (std::size_t i = 0; i < a.targets.size(); ++i)
    for (std::size_t j = 0; j < b.targets.size(); ++j) {
      if (a.targets[i]->id != b.targets[j]->id) continue;
      const std::size_t seen = std::min(FoundIn(a, static_cast<int>(i)), FoundIn(b, static_cast<int>(j)));
      if (seen > most) most = seen, best = {static_cast<int>(i), static_cast<int>(j)};
    }
  return best;
}

class ClockFinder {
 public:
  explicit ClockFinder(const std::vector<WatchedCamera>& cameras) : cameras_(cameras), clocks_(cameras.size()) {
    begin_ns_ = INT64_MAX;
    for (const WatchedCamera& camera : cameras)
      for (const Sight& sight : *camera.sights) begin_ns_ = std::min(begin_ns_, sight.stamp_ns);
  }

  std::vector<SensorClock> Find(std::size_t reference) {
    for (std::size_t c = 0; c < cameras_.size(); ++c)
      if (cameras_[c].stated_offset_s) {
        clocks_[c].source = ClockSource::kStated;
        clocks_[c].offset_s = *cameras_[c].stated_offset_s;
      }
    if (clocks_[reference].source == ClockSource::kUnknown) clocks_[reference].source = ClockSource::kReference;
    while (TieOne()) {
    }
    return std::move(clocks_);
  }

 private:
  // Of the first camera that is not known, to the first that is.
  bool TieOne() {
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      if (clocks_[c].source != ClockSource::kUnknown) continue;
      for (std::size_t known = 0; known < cameras_.size(); ++known)
        if (clocks_[known].source != ClockSource::kUnknown && Tie(c, known)) return true;
    }
    return false;
  }

  bool Tie(std::size_t c, std::size_t known) {
    if (!tried_.emplace(std::pair(c, known), true).second) return false;
    const CommonBoard board = CommonBoardOf(cameras_[known], cameras_[c]);
    if (board.idx_a < 0) return false;
    const Eigen::Vector3d centre_m = CentreOf(*cameras_[c].targets[static_cast<std::size_t>(board.idx_b)]);
    const auto &track = TrackOf(known, board.idx_a), &other = TrackOf(c, board.idx_b);
    const bool swapped = other.size() > track.size();  // the denser one is interpolated
    auto fit = swapped ? FitClock(other, track, centre_m) : FitClock(track, other, centre_m);
    if (!fit) return false;
    if (swapped) fit->offset_s = -fit->offset_s, fit->drift_ratio = -fit->drift_ratio;
    Set(c, clocks_[known], *fit);
    return true;
  }

  void Set(std::size_t c, const SensorClock& known, const ClockFit& fit) {
    SensorClock& clock = clocks_[c];
    clock.source = ClockSource::kEstimated;
    clock.at_ns = begin_ns_ + std::llround(fit.at_s * 1e9);
    const double since_s = known.at_ns == 0 ? 0.0 : static_cast<double>(clock.at_ns - known.at_ns) * 1e-9;
    clock.offset_s = fit.offset_s + known.offset_s + known.drift_ratio * since_s;
    clock.drift_ratio = fit.drift_ratio + known.drift_ratio;
    clock.offset_sigma_s = std::hypot(fit.offset_sigma_s, known.offset_sigma_s, known.drift_sigma_ratio * since_s);
    clock.drift_sigma_ratio = std::hypot(fit.drift_sigma_ratio, known.drift_sigma_ratio);
  }

  const std::vector<TimedPose>& TrackOf(std::size_t c, int target_idx) {
    const auto known = tracks_.find({c, target_idx});
    if (known != tracks_.end()) return known->second;
    const Target& target = *cameras_[c].targets[static_cast<std::size_t>(target_idx)];
    return tracks_[{c, target_idx}] = PosesOf(*cameras_[c].camera, target, target_idx, *cameras_[c].sights, begin_ns_);
  }

  const std::vector<WatchedCamera>& cameras_;
  std::vector<SensorClock> clocks_;
  std::int64_t begin_ns_ = 0;
  std::map<std::pair<std::size_t, std::size_t>, bool> tried_;
  std::map<std::pair<std::size_t, int>, std::vector<TimedPose>> tracks_;
};

}  // namespace

std::string NameOf(ClockSource source) { return kClockNames[static_cast<std::size_t>(source)]; }

std::optional<ClockSource> ClockSourceOf(const std::string& name) {
  for (const ClockSource source :
       {ClockSource::kReference, ClockSource::kStated, ClockSource::kEstimated, ClockSource::kUnknown})
    if (NameOf(source) == name) return source;
  return std::nullopt;
}

std::int64_t SensorClock::OnReference_ns(std::int64_t stamp_ns) const {
  return stamp_ns - std::llround(1e9 * offset_s + drift_ratio * static_cast<double>(stamp_ns - at_ns));
}

std::optional<std::int64_t> SensorClock::Sigma_ns(std::int64_t first_ns, std::int64_t last_ns) const {
  if (source == ClockSource::kUnknown) return std::nullopt;
  if (source != ClockSource::kEstimated) return 0;
  const double farthest_ns = static_cast<double>(std::max(std::abs(first_ns - at_ns), std::abs(last_ns - at_ns)));
  return std::llround(std::hypot(1e9 * offset_sigma_s, drift_sigma_ratio * farthest_ns));
}

std::vector<SensorClock> ClocksOf(const std::vector<WatchedCamera>& cameras, const SensorId& reference) {
  if (cameras.empty()) return {};
  std::size_t chosen = 0;
  for (std::size_t c = 1; c < cameras.size(); ++c)
    if (FoundIn(cameras[c], -1) > FoundIn(cameras[chosen], -1)) chosen = c;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    if (cameras[c].camera->id == reference) chosen = c;
  return ClockFinder(cameras).Find(chosen);
}

}  // namespace rigcal::moments
