#include "tests/bench/pairs/stereo_splits.h"

#include <algorithm>
#include <cstdio>
#include <functional>

#include "server/formats/json/json_writer.h"
#include "tests/bench/pairs/stereo_pictures.h"

namespace rigcal {
namespace {

using PlaceOf = std::function<double(const calib::StereoCapture&)>;

// Column of the board's middle in the left picture.
double Column_px(const calib::StereoCapture& capture) {
  double sum = 0;
  for (const Eigen::Vector2d& corner : capture.a->corners_px) sum += corner.x();
  return sum / static_cast<double>(capture.a->corners_px.size());
}

// Length of the pattern's diagonal in the left picture.
double Size_px(const calib::StereoCapture& capture) {
  return (capture.a->corners_px.back() - capture.a->corners_px.front()).norm();
}

// The captures below and above the median place.
std::pair<calib::StereoProblem, calib::StereoProblem> Split(const calib::StereoProblem& problem, const PlaceOf& place) {
  std::vector<calib::StereoCapture> captures = problem.captures;
  std::erase_if(captures, [](const calib::StereoCapture& capture) {
    return !capture.a || !capture.b || !capture.a->found || !capture.b->found;
  });
  std::stable_sort(captures.begin(), captures.end(),
                   [&](const auto& one, const auto& other) { return place(one) < place(other); });
  const auto middle = captures.begin() + static_cast<std::ptrdiff_t>(captures.size() / 2);
  std::pair halves{problem, problem};
  halves.first.captures.assign(captures.begin(), middle);
  halves.second.captures.assign(middle, captures.end());
  return halves;
}

void WriteSplit(const char* name, const calib::StereoProblem& problem, const PlaceOf& place, formats::JsonWriter& out) {
  const auto [low, high] = Split(problem, place);
  const Edge a = calib::EstimateEdge(low), b = calib::EstimateEdge(high);
  out.Object(name, [&] {
    out.Integer("captures_low", static_cast<std::int64_t>(low.captures.size()));
    out.Integer("captures_high", static_cast<std::int64_t>(high.captures.size()));
    out.Flag("good", a.state == EdgeState::kGood && b.state == EdgeState::kGood);
    if (a.state != EdgeState::kGood || b.state != EdgeState::kGood) return;
    const Vector6d difference = (a.T_a_b.Inverse() * b.T_a_b).Log();
    const Vector6d variance = a.uncertainty.covariance.diagonal() + b.uncertainty.covariance.diagonal();
    out.Number("sigmas", (difference.array().abs() / variance.array().sqrt()).maxCoeff());
    out.Number("apart_mm", 1e3 * difference.head<3>().norm());
    out.Number("apart_deg", 180 / M_PI * difference.tail<3>().norm());
  });
}

}  // namespace

int PrintSplits(const std::filesystem::path& folder) {
  const calib::StereoProblem problem = StereoProblemOf(folder);
  formats::JsonWriter out;
  out.Object([&] {
    WriteSplit("left_right", problem, Column_px, out);
    WriteSplit("near_far", problem, Size_px, out);
  });
  std::printf("%s\n", out.Finish().c_str());
  return 0;
}

}  // namespace rigcal
