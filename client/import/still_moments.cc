#include "client/import/still_moments.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/import/stream_kind.h"
#include "client/import/watch.h"

namespace rigcal::importing {
namespace {

using moments::ClockSource;
using moments::Stream;

constexpr std::int64_t kReachMax_ns = 250'000'000;  // from one message of a moment to the others

bool FormsCaptures(SensorKind kind) { return kind == SensorKind::kCamera || kind == SensorKind::kLidar; }

std::string Figure(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}
std::string MotionText(double px, double m) {
  return Figure(m * 1e3, m < 0.01 ? 2 : 0) + " mm, " + Figure(px, px < 10 ? 2 : 0) + " px";
}

bool ShowsABoard(const std::vector<WatchedPictures>& watched) {
  return std::any_of(watched.begin(), watched.end(), [](const WatchedPictures& sensor) {
    return std::any_of(sensor.sights.begin(), sensor.sights.end(),
                       [](const moments::Sight& sight) { return sight.found(); });
  });
}

class MomentFinder {
 public:
  MomentFinder(const RigMap& map, const Intake& intake, std::vector<WatchedPictures> watched)
      : map_(map), intake_(intake), watched_(std::move(watched)), clocks_(map.sensors.size()) {}

  Result<StillMoments> Find() {
    SetClocks();
    MakeStreams();
    const CapturePlan candidates = PlanCaptures(StampsOf(), Reach_ns(), 0);
    std::vector<moments::Moment> all;
    for (const PlannedCapture& capture : candidates.captures) all.push_back({capture.stamp_ns, capture.message});
    found_.told.limits = {map_.motion_px, map_.motion_m, map_.every_ns};
    const moments::Choice choice = moments::Choose(streams_, all, found_.told.limits, SensorsMin());
    Tell(choice);
    if (choice.kept.empty()) return Refuse();
    for (const moments::Moment& moment : choice.kept) found_.plan.captures.push_back(CaptureOf(moment, candidates));
    CountUses(candidates);
    return std::move(found_);
  }

 private:
  void SetClocks() {
    std::vector<moments::WatchedCamera> cameras;
    std::vector<std::size_t> sensors;
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) {
      const Sensor& sensor = *SensorOf(map_.header, map_.sensors[s].id);
      if (sensor.kind == SensorKind::kCamera) {
        // Stamps are on the rig's clock already where its offset is stated.
        const auto left_s = map_.sensors[s].clock_offset_s ? std::optional(0.0) : std::nullopt;
        cameras.push_back({&sensor, TargetsOf(map_.header, sensor), &watched_[s].sights, left_s});
        sensors.push_back(s);
      } else if (map_.sensors[s].clock_offset_s) {
        clocks_[s].source = ClockSource::kStated;
      }
    }
    const std::vector<moments::SensorClock> found = moments::ClocksOf(cameras, map_.header.reference);
    for (std::size_t c = 0; c < sensors.size(); ++c) {
      clocks_[sensors[c]] = found[c];
      found_.told.clocks.push_back({map_.sensors[sensors[c]].id.str(), found[c]});
      if (found[c].source == ClockSource::kStated)
        found_.told.clocks.back().clock.offset_s = *map_.sensors[sensors[c]].clock_offset_s;
    }
  }

  void MakeStreams() {
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) {
      const SensorIntake& taken = intake_.sensors[s];
      Stream stream;
      stream.kind = map_.sensors[s].kind == SensorKind::kCamera  ? Stream::Kind::kCamera
                    : map_.sensors[s].kind == SensorKind::kLidar ? Stream::Kind::kCloud
                                                                 : Stream::Kind::kPoses;
      if (map_.sensors[s].kind != SensorKind::kPoseStream) {
        for (const std::int64_t stamp_ns : taken.stamps_ns)
          stream.stamps_ns.push_back(clocks_[s].OnReference_ns(stamp_ns));
        for (const Se3& T : taken.poses) stream.places_m.push_back(T.p_m);
      }
      stream.sights = std::move(watched_[s].sights);
      if (!taken.stamps_ns.empty()) {
        const auto [first, last] = std::minmax_element(taken.stamps_ns.begin(), taken.stamps_ns.end());
        stream.clock_sigma_ns = clocks_[s].Sigma_ns(*first, *last);
      }
      found_.unreadable.push_back(watched_[s].unreadable);
      found_.first_trouble.push_back(watched_[s].first_trouble);
      streams_.push_back(std::move(stream));
    }
  }

  [[nodiscard]] std::vector<SensorStamps> StampsOf() const {
    std::vector<SensorStamps> stamps;
    for (std::size_t s = 0; s < streams_.size(); ++s)
      stamps.push_back({streams_[s].stamps_ns, FormsCaptures(map_.sensors[s].kind)});
    return stamps;
  }

  // Half of the slowest sensor's period: farther away, another of its messages is nearer.
  [[nodiscard]] std::int64_t Reach_ns() const {
    std::int64_t reach_ns = map_.tolerance_ns;
    for (std::size_t s = 0; s < streams_.size(); ++s)
      if (FormsCaptures(map_.sensors[s].kind))
        reach_ns = std::max(reach_ns, std::min(kReachMax_ns, Period_ns(streams_[s].stamps_ns).value_or(0) / 2));
    return reach_ns;
  }

  [[nodiscard]] std::size_t SensorsMin() const {
    const auto forming = std::count_if(map_.sensors.begin(), map_.sensors.end(),
                                       [](const MappedSensor& sensor) { return FormsCaptures(sensor.kind); });
    return forming > 1 ? 2 : 1;
  }

  void Tell(const moments::Choice& choice) {
    MomentsTold& told = found_.told;
    told.moments = choice.moments, told.chosen = choice.kept.size(), told.left_out = choice.left_out;
    told.least_motion_px = choice.least_motion_px, told.least_motion_m = choice.least_motion_m;
    told.usual_motion_px = choice.usual_motion_px, told.usual_motion_m = choice.usual_motion_m;
    told.worst_kept_px = choice.worst_kept_px, told.worst_kept_m = choice.worst_kept_m;
  }

  [[nodiscard]] tl::unexpected<Error> Refuse() const {
    return Fail(
        ErrorCode::kInvalidInput, "the bag has no still moment that is a capture. " + MomentsText(found_.told),
        "Hold the board still for a second at each place. `motion_px` and `motion_m` in rig.yaml set what is still, "
        "`moments: all` takes every message that has a partner (docs/bags.md).");
  }

  static PlannedCapture CaptureOf(const moments::Moment& moment, const CapturePlan& candidates) {
    const auto planned =
        std::lower_bound(candidates.captures.begin(), candidates.captures.end(), moment.stamp_ns,
                         [](const PlannedCapture& one, std::int64_t at_ns) { return one.stamp_ns < at_ns; });
    return {planned->name, moment.stamp_ns, moment.message};
  }

  // Messages of moments that were left out, or that were taken out of a moment.
  void CountUses(const CapturePlan& candidates) {
    found_.plan.uses = candidates.uses;
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      std::size_t kept = 0;
      for (const PlannedCapture& capture : found_.plan.captures) kept += capture.message[s] ? 1 : 0;
      SensorUse& use = found_.plan.uses[s];
      use.left_out = use.used > kept ? use.used - kept : 0;
      use.used = kept;
    }
  }

  const RigMap& map_;
  const Intake& intake_;
  std::vector<WatchedPictures> watched_;
  std::vector<moments::SensorClock> clocks_;
  std::vector<Stream> streams_;
  StillMoments found_;
};

}  // namespace

std::string MomentsText(const MomentsTold& told) {
  std::string text = std::to_string(told.chosen) + " of " + std::to_string(told.moments) + " moments are captures";
  if (told.chosen > 0) text += ", which move by " + MotionText(told.worst_kept_px, told.worst_kept_m) + " at most";
  std::string reasons;
  for (std::size_t i = 0; i < told.left_out.size(); ++i) {
    if (told.left_out[i] == 0) continue;
    const auto why = static_cast<moments::LeftOut>(i);
    reasons += (reasons.empty() ? "" : "; ") + std::to_string(told.left_out[i]) + " " + moments::Words(why);
    if (why == moments::LeftOut::kMoved)
      reasons += " (" + MotionText(told.usual_motion_px, told.usual_motion_m) + " in the middle, " +
                 MotionText(told.least_motion_px, told.least_motion_m) + " at least; allowed are " +
                 MotionText(told.limits.motion_px, told.limits.motion_m) + ")";
  }
  return text + (reasons.empty() ? "." : ". Left out: " + reasons + ".");
}

std::string ClocksText(const MomentsTold& told) {
  std::string text;
  for (const MomentsTold::Clock& one : told.clocks) {
    const moments::SensorClock& clock = one.clock;
    if (clock.source == ClockSource::kReference) continue;
    text += (text.empty() ? "" : "; ") + one.sensor;
    if (clock.source == ClockSource::kUnknown) text += " not known";
    if (clock.source == ClockSource::kStated) text += " " + Figure(clock.offset_s * 1e3, 2) + " ms as stated";
    if (clock.source == ClockSource::kEstimated)
      text += " " + Figure(clock.offset_s * 1e3, 2) + " ms (sigma " + Figure(clock.offset_sigma_s * 1e3, 2) + "), " +
              Figure(clock.drift_ratio * 1e6, 1) + " ppm (sigma " + Figure(clock.drift_sigma_ratio * 1e6, 1) + ")";
  }
  return text;
}

bool WantsStillMoments(const RigMap& map, const Intake& intake) {
  if (map.moments != MomentsWanted::kAuto) return map.moments == MomentsWanted::kStill;
  std::vector<SensorStamps> cameras, others;
  for (std::size_t s = 0; s < map.sensors.size(); ++s) {
    if (map.sensors[s].kind == SensorKind::kCamera) cameras.push_back({intake.sensors[s].stamps_ns, true});
    if (map.sensors[s].kind == SensorKind::kLidar) others.push_back({intake.sensors[s].stamps_ns, true});
  }
  return RunsFreely(cameras, others, map.tolerance_ns);
}

Result<std::optional<StillMoments>> FindStillMoments(const std::filesystem::path& bag, const RigMap& map,
                                                     const Intake& intake, const Progress& progress) {
  RIGCAL_ASSIGN(std::vector<WatchedPictures> watched, WatchPictures(bag, map, intake, progress));
  if (map.moments == MomentsWanted::kAuto && !ShowsABoard(watched)) return std::optional<StillMoments>();
  RIGCAL_ASSIGN(StillMoments found, MomentFinder(map, intake, std::move(watched)).Find());
  return std::optional(std::move(found));
}

}  // namespace rigcal::importing
