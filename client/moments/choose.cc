#include "client/moments/choose.h"

#include <algorithm>
#include <cmath>

#include "client/check/edge_width.h"
#include "client/moments/motion.h"

namespace rigcal::moments {
namespace {

constexpr double kBrightMost_ratio = 0.25, kContrastMin_grey = 40;
constexpr std::int64_t kExposure_ns = 10'000'000, kSweep_ns = 100'000'000, kClockUnknown_ns = 100'000'000;
constexpr double kOnePlace = 10;  // times the limits of motion: moments nearer to each other show the same
constexpr double kClockSigmas = 3;

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of a camera's pictures, from which on edges are blurred.
double BlurredFrom_px(const Stream& stream) {
  std::vector<double> widths_px;
  int width_px = 0;
  for (const Sight& sight : stream.sights) {
    width_px = std::max(width_px, sight.width_px);
    if (sight.edge_px) widths_px.push_back(*sight.edge_px);
  }
  return check::BlurredFrom_px(width_px, MedianOf(std::move(widths_px)));
}

// A moment that is judged: what is left of it, and how far it moves.
struct Judged {
  Moment moment;
  Shift motion;
  std::size_t sensors = 0;
};

class Chooser {
 public:
  Chooser(const std::vector<Stream>& streams, const MomentLimits& limits, std::size_t sensors_min)
      : streams_(streams), limits_(limits), sensors_min_(sensors_min) {
    for (const Stream& stream : streams) {
      tellers_.emplace_back(stream);
      blurred_from_px_.push_back(stream.kind == Stream::Kind::kCamera ? BlurredFrom_px(stream) : 0.0);
    }
  }

  Choice Run(std::vector<Moment> moments) {
    std::sort(moments.begin(), moments.end(), [](const Moment& a, const Moment& b) { return a.stamp_ns < b.stamp_ns; });
    choice_.moments = moments.size();
    std::vector<Judged> good;
    for (Moment& moment : moments) {
      Judged judged{std::move(moment), {}, 0};
      if (const auto why = WhyNot(judged))
        ++CountOf(*why);
      else
        good.push_back(std::move(judged));
    }
    KeepOnePerPlace(std::move(good));
    choice_.usual_motion_px = MedianOf(moved_px_), choice_.usual_motion_m = MedianOf(moved_m_);
    if (!moved_px_.empty()) {
      choice_.least_motion_px = *std::min_element(moved_px_.begin(), moved_px_.end());
      choice_.least_motion_m = *std::min_element(moved_m_.begin(), moved_m_.end());
    }
    return std::move(choice_);
  }

 private:
  std::size_t& CountOf(LeftOut why) { return choice_.left_out[static_cast<std::size_t>(why)]; }

  [[nodiscard]] std::size_t SensorsOf(const Moment& moment) const {
    std::size_t sensors = 0;
    for (const auto& message : moment.message) sensors += message ? 1 : 0;
    return sensors;
  }

  // Takes pictures out by `is_bad` of camera and sight; true: too few sensors are left.
  template <typename IsBad>
  bool TakeOut(Moment& moment, const IsBad& is_bad) const {
    for (std::size_t s = 0; s < streams_.size(); ++s)
      if (streams_[s].kind == Stream::Kind::kCamera && moment.message[s] &&
          is_bad(s, streams_[s].sights[*moment.message[s]]))
        moment.message[s].reset();
    return SensorsOf(moment) < sensors_min_;
  }

  std::optional<LeftOut> WhyNot(Judged& judged) {
    Moment& moment = judged.moment;
    if (TakeOut(moment, [](std::size_t, const Sight& sight) { return !sight.found(); })) return LeftOut::kNoBoard;
    const auto motion = MotionOf(moment);
    if (!motion) return LeftOut::kMotionUnknown;
    judged.motion = *motion;
    if (motion->px > limits_.motion_px || motion->m > limits_.motion_m) {
      moved_px_.push_back(motion->px), moved_m_.push_back(motion->m);
      return LeftOut::kMoved;
    }
    if (TakeOut(moment,
                [&](std::size_t s, const Sight& sight) { return sight.edge_px.value_or(0) >= blurred_from_px_[s]; }))
      return LeftOut::kBlurred;
    if (TakeOut(moment, [](std::size_t, const Sight& sight) {
          return sight.bright_ratio > kBrightMost_ratio || sight.contrast_grey < kContrastMin_grey;
        }))
      return LeftOut::kExposure;
    judged.sensors = SensorsOf(moment);
    return std::nullopt;
  }

  // From the first to the last of its messages, and what is not known of them.
  [[nodiscard]] std::int64_t SpanOf(const Moment& moment) const {
    std::int64_t first_ns = INT64_MAX, last_ns = INT64_MIN;
    double clocks_ns = 0;
    bool sweeps = false;
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      if (!moment.message[s]) continue;
      const std::int64_t stamp_ns = streams_[s].stamps_ns[*moment.message[s]];
      first_ns = std::min(first_ns, stamp_ns), last_ns = std::max(last_ns, stamp_ns);
      const auto& sigma_ns = streams_[s].clock_sigma_ns;
      clocks_ns = std::max(clocks_ns, sigma_ns ? kClockSigmas * static_cast<double>(*sigma_ns) : kClockUnknown_ns);
      sweeps = sweeps || streams_[s].kind == Stream::Kind::kCloud;
    }
    return last_ns - first_ns + kExposure_ns + (sweeps ? kSweep_ns : 0) + std::llround(clocks_ns);
  }

  // The largest of its cameras and poses; nothing where one is not told, or none tells any.
  [[nodiscard]] std::optional<Shift> MotionOf(const Moment& moment) const {
    const std::int64_t span_ns = SpanOf(moment);
    std::optional<Shift> most;
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      if (!moment.message[s] || streams_[s].kind == Stream::Kind::kCloud) continue;
      const auto motion = tellers_[s].About(*moment.message[s], span_ns);
      if (!motion) return std::nullopt;
      most = most ? Shift{std::max(most->px, motion->px), std::max(most->m, motion->m)} : *motion;
    }
    return most;
  }

  // Whether no camera that both have saw the board anywhere else.
  [[nodiscard]] bool AreOnePlace(const Moment& a, const Moment& b) const {
    bool seen = false;
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      if (streams_[s].kind != Stream::Kind::kCamera || !a.message[s] || !b.message[s]) continue;
      const auto shift = ShiftBetween(streams_[s].sights[*a.message[s]], streams_[s].sights[*b.message[s]]);
      if (!shift || (shift->px > kOnePlace * limits_.motion_px && shift->m > kOnePlace * limits_.motion_m))
        return false;
      seen = true;
    }
    return seen;
  }

  // More sensors; of as many the stiller.
  [[nodiscard]] bool IsBetter(const Judged& a, const Judged& b) const {
    if (a.sensors != b.sensors) return a.sensors > b.sensors;
    const auto part = [&](const Judged& one) {
      return std::max(one.motion.px / limits_.motion_px, one.motion.m / limits_.motion_m);
    };
    return part(a) < part(b);
  }

  void KeepOnePerPlace(std::vector<Judged> good) {
    std::vector<Judged> best;
    for (Judged& judged : good) {
      if (best.empty() || !AreOnePlace(best.back().moment, judged.moment)) {
        best.push_back(std::move(judged));
        continue;
      }
      ++CountOf(LeftOut::kSamePlace);
      if (IsBetter(judged, best.back())) best.back() = std::move(judged);
    }
    std::int64_t last_ns = INT64_MIN;
    for (Judged& judged : best) {
      if (!choice_.kept.empty() && judged.moment.stamp_ns - last_ns < limits_.every_ns) {
        ++CountOf(LeftOut::kTooSoon);
        continue;
      }
      last_ns = judged.moment.stamp_ns;
      choice_.worst_kept_px = std::max(choice_.worst_kept_px, judged.motion.px);
      choice_.worst_kept_m = std::max(choice_.worst_kept_m, judged.motion.m);
      choice_.kept.push_back(std::move(judged.moment));
    }
  }

  const std::vector<Stream>& streams_;
  const MomentLimits& limits_;
  std::size_t sensors_min_;
  std::vector<MotionTeller> tellers_;
  std::vector<double> blurred_from_px_, moved_px_, moved_m_;
  Choice choice_;
};

}  // namespace

std::string Words(LeftOut why) {
  static constexpr const char* kWords[] = {"the board in view of too few sensors",
                                           "something moved",
                                           "motion not known",
                                           "blurred",
                                           "too bright or too dark",
                                           "at a place that has a better one",
                                           "too soon after another"};
  return kWords[static_cast<std::size_t>(why)];
}

std::string NameOf(LeftOut why) {
  static constexpr const char* kNames[] = {"no_board", "moved",      "motion_unknown", "blurred",
                                           "exposure", "same_place", "too_soon"};
  return kNames[static_cast<std::size_t>(why)];
}

Choice Choose(const std::vector<Stream>& streams, const std::vector<Moment>& moments, const MomentLimits& limits,
              std::size_t sensors_min) {
  return Chooser(streams, limits, sensors_min).Run(moments);
}

}  // namespace rigcal::moments
