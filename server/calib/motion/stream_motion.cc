#include "server/calib/motion/stream_motion.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr double kNanosecondsPerSecond = 1e-9;
constexpr std::size_t kCellsMax = 4096;  // of a stream, in the first search
constexpr double kCell_s = 0.02;
constexpr double kOverlapLeast_ratio = 0.25;  // of the shorter stream
constexpr std::size_t kOverlapLeast_cells = 64;
constexpr int kRefinements = 12;
constexpr std::size_t kSamples = 400;

double SecondsSince(const PoseTable& stream, std::size_t row) {
  return kNanosecondsPerSecond * static_cast<double>(stream[row].stamp.ns - stream.front().stamp.ns);
}

// Angle turned since the first row, by time.
struct Turning {
  std::vector<double> times_s, angles_rad;

  explicit Turning(const PoseTable& stream) {
    double angle = 0;
    for (std::size_t i = 0; i < stream.size(); ++i) {
      if (i > 0) angle += stream[i - 1].T_world_body.q.angularDistance(stream[i].T_world_body.q);
      times_s.push_back(SecondsSince(stream, i));
      angles_rad.push_back(angle);
    }
  }
  [[nodiscard]] double AngleAt(double time_s) const {
    const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s);
    if (after == times_s.begin()) return angles_rad.front();
    if (after == times_s.end()) return angles_rad.back();
    const auto i = static_cast<std::size_t>(after - times_s.begin());
    const double part = (time_s - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
    return angles_rad[i - 1] + part * (angles_rad[i] - angles_rad[i - 1]);
  }
  // Mean angular speeds of cells of `cell_s` from `start_s` on.
  [[nodiscard]] std::vector<double> Speeds(double start_s, double cell_s, std::size_t count) const {
    std::vector<double> speeds;
    for (std::size_t i = 0; i < count; ++i) {
      const double from = start_s + cell_s * static_cast<double>(i);
      speeds.push_back((AngleAt(from + cell_s) - AngleAt(from)) / cell_s);
    }
    return speeds;
  }
};

// Pearson's correlation of x[i + lag] with y[i] where both are there; 0 where they overlap too little.
double CorrelationAt(const std::vector<double>& x, const std::vector<double>& y, std::ptrdiff_t lag,
                     std::size_t overlap_min) {
  const auto size_x = static_cast<std::ptrdiff_t>(x.size()), size_y = static_cast<std::ptrdiff_t>(y.size());
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, -lag), end = std::min(size_y, size_x - lag);
  if (end - begin < static_cast<std::ptrdiff_t>(overlap_min)) return 0;
  double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
  for (std::ptrdiff_t i = begin; i < end; ++i) {
    const double u = x[static_cast<std::size_t>(i + lag)], v = y[static_cast<std::size_t>(i)];
    sx += u, sy += v, sxx += u * u, syy += v * v, sxy += u * v;
  }
  const auto n = static_cast<double>(end - begin);
  const double cross = sxy - sx * sy / n, vx = sxx - sx * sx / n, vy = syy - sy * sy / n;
  return vx > 0 && vy > 0 ? cross / std::sqrt(vx * vy) : 0;
}

// Where the two overlap at this offset, by cells of the fine grid that lie on it exactly.
double FineCorrelation(const Turning& a, const Turning& b, double offset_s) {
  const double from = std::max(0.0, offset_s), to = std::min(a.times_s.back(), b.times_s.back() + offset_s);
  const auto count = static_cast<std::size_t>(std::max(0.0, (to - from) / kCell_s));
  const std::size_t used = std::min<std::size_t>(count, 1U << 15);
  if (used < 2) return 0;
  const double cell_s = std::max(kCell_s, (to - from) / static_cast<double>(used));
  return CorrelationAt(a.Speeds(from, cell_s, used), b.Speeds(from - offset_s, cell_s, used), 0, 2);
}

}  // namespace

StreamSpan SpanOf(const PoseTable& stream) {
  StreamSpan span;
  if (stream.empty()) return span;
  span.seconds = SecondsSince(stream, stream.size() - 1);
  for (const TimedPose& row : stream)
    span.turn_rad = std::max(span.turn_rad, stream.front().T_world_body.q.angularDistance(row.T_world_body.q));
  return span;
}

double SecondsInCommon(const PoseTable& a, const PoseTable& b, double offset_s) {
  const double until_s = std::min(SpanOf(a).seconds, SpanOf(b).seconds + offset_s);
  return std::max(0.0, until_s - std::max(0.0, offset_s));
}

std::optional<ClockOffset> CorrelateClocks(const PoseTable& table_a, const PoseTable& table_b) {
  if (table_a.size() < 2 || table_b.size() < 2) return std::nullopt;
  const Turning a(table_a), b(table_b);
  const double longest_s = std::max(a.times_s.back(), b.times_s.back());
  const double cell_s = std::max(kCell_s, longest_s / static_cast<double>(kCellsMax));
  const auto cells = [&](const Turning& turning) { return static_cast<std::size_t>(turning.times_s.back() / cell_s); };
  const std::vector<double> x = a.Speeds(0, cell_s, cells(a)), y = b.Speeds(0, cell_s, cells(b));
  const auto overlap_min =
      std::max(kOverlapLeast_cells,
               static_cast<std::size_t>(kOverlapLeast_ratio * static_cast<double>(std::min(x.size(), y.size()))));
  ClockOffset best;
  for (auto lag = -static_cast<std::ptrdiff_t>(y.size()); lag <= static_cast<std::ptrdiff_t>(x.size()); ++lag)
    if (const double value = CorrelationAt(x, y, lag, overlap_min); value > best.correlation_ratio)
      best = {cell_s * static_cast<double>(lag), value};
  if (!(best.correlation_ratio > 0)) return std::nullopt;
  double step_s = cell_s / 2;
  best.correlation_ratio = FineCorrelation(a, b, best.offset_s);
  for (int i = 0; i < kRefinements; ++i, step_s /= 2)
    for (const double offset_s : {best.offset_s - step_s, best.offset_s + step_s})
      if (const double value = FineCorrelation(a, b, offset_s); value > best.correlation_ratio)
        best = {offset_s, value};
  return best;
}

std::optional<StreamPose> PoseAt(const PoseTable& stream, double time_s) {
  const std::int64_t origin_ns = stream.front().stamp.ns;
  if (!(time_s >= 0 && time_s <= SecondsSince(stream, stream.size() - 1))) return std::nullopt;
  const auto after =
      std::lower_bound(stream.begin() + 1, stream.end() - 1, time_s, [&](const TimedPose& row, double t) {
        return kNanosecondsPerSecond * static_cast<double>(row.stamp.ns - origin_ns) < t;
      });
  const auto i = static_cast<std::size_t>(after - stream.begin());
  const double from_s = SecondsSince(stream, i - 1), gap_s = SecondsSince(stream, i) - from_s;
  if (gap_s > kStreamGapMax_s) return std::nullopt;
  const Vector6d step = (stream[i - 1].T_world_body.Inverse() * stream[i].T_world_body).Log();
  return StreamPose{stream[i - 1].T_world_body * Se3::Exp((time_s - from_s) / gap_s * step), step / gap_s};
}

CommonPoses PosesInCommon(const PoseTable& a, const PoseTable& b, double offset_s) {
  struct Row {
    double path;  // turned and travelled so far, rad + m
    double time_s;
    std::size_t row;
  };
  std::vector<Row> rows;
  double path = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double time_s = SecondsSince(a, i);
    if (!PoseAt(b, time_s - offset_s)) continue;
    if (!rows.empty()) {
      const Vector6d step = (a[rows.back().row].T_world_body.Inverse() * a[i].T_world_body).Log();
      path += step.head<3>().norm() + step.tail<3>().norm();
    }
    rows.push_back({path, time_s, i});
  }
  CommonPoses common;
  double next = 0;
  for (const Row& row : rows) {
    if (row.path < next) continue;
    next = row.path + path / static_cast<double>(kSamples);
    common.times_s.push_back(row.time_s);
    common.a.push_back(a[row.row].T_world_body);
    common.b.push_back(*PoseAt(b, row.time_s - offset_s));
  }
  return common;
}

}  // namespace rigcal::calib
