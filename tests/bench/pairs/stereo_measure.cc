// Measures the stereo calibration on a folder of leftNN.jpg and rightNN.jpg (9 x 6 inner corners, 25 mm):
// stereo_measure FOLDER prints one JSON object.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tests/bench/pairs/stereo_pictures.h"

namespace rigcal {
namespace {

struct BoardCount {
  int found = 0, total = 0;
};

BoardCount CountBoards(const calib::StereoProblem& problem) {
  BoardCount count;
  for (const auto& capture : problem.captures)
    for (const auto& view : {capture.a, capture.b}) {
      if (!view) continue;
      ++count.total;
      count.found += view->found ? 1 : 0;
    }
  return count;
}

// The captures whose number is odd, or even.
calib::StereoProblem Half(const calib::StereoProblem& problem, bool odd) {
  calib::StereoProblem half = problem;
  half.captures.clear();
  for (const calib::StereoCapture& capture : problem.captures)
    if (((capture.capture.str().back() - '0') % 2 != 0) == odd) half.captures.push_back(capture);
  return half;
}

// Largest |difference| / sqrt(sigma^2 + sigma^2) over the six axes; negative if one half gives no edge.
double OddEvenRatio(const calib::StereoProblem& problem) {
  const Edge odd = calib::EstimateEdge(Half(problem, true)), even = calib::EstimateEdge(Half(problem, false));
  if (odd.state != EdgeState::kGood || even.state != EdgeState::kGood) return -1;
  const Vector6d difference = (odd.T_a_b.Inverse() * even.T_a_b).Log();
  const Vector6d variance = odd.uncertainty.covariance.diagonal() + even.uncertainty.covariance.diagonal();
  return (difference.array().abs() / variance.array().sqrt()).maxCoeff();
}

template <typename Body>
double Milliseconds(const Body& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

int Complain(const Error& error) {
  std::fprintf(stderr, "%s\n", Sentence(error).c_str());
  return 1;
}

int Measure(const std::filesystem::path& folder) {
  calib::StereoProblem problem;
  const double detect_ms = Milliseconds([&] { problem = StereoProblemOf(folder); });
  Result<calib::StereoEstimate> estimate = Fail(ErrorCode::kInternal, "not estimated", "");
  const double estimate_ms = Milliseconds([&] { estimate = calib::Estimate(problem); });
  if (!estimate) return Complain(estimate.error());
  Result<Uncertainty> uncertainty = Fail(ErrorCode::kInternal, "not estimated", "");
  const double jackknife_ms = Milliseconds([&] { uncertainty = calib::Jackknife(problem, *estimate); });
  if (!uncertainty) return Complain(uncertainty.error());

  const BoardCount boards = CountBoards(problem);
  const Vector6d sigma = uncertainty->covariance.diagonal().cwiseSqrt();
  const Vector6d shown = (Vector6d() << 1e3 * sigma.head<3>(), 180 / M_PI * sigma.tail<3>()).finished();
  std::printf("{\"boards_found\": %d, \"boards_total\": %d, \"rms_px\": %.6f, \"t_norm_mm\": %.6f, ", boards.found,
              boards.total, estimate->rms_px, 1e3 * estimate->T_a_b.p_m.norm());
  std::printf(
      "\"odd_even_max_sigma_ratio\": %.4f, \"detect_ms\": %.1f, \"estimate_ms\": %.1f, \"jackknife_ms\": %.1f, ",
      OddEvenRatio(problem), detect_ms, estimate_ms, jackknife_ms);
  std::printf("\"sigma_mm\": [%.5f, %.5f, %.5f], \"sigma_deg\": [%.6f, %.6f, %.6f]}\n", shown[0], shown[1], shown[2],
              shown[3], shown[4], shown[5]);
  return 0;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  if (argc != 2 || !std::filesystem::is_directory(argv[1])) {
    std::fprintf(stderr, "usage: stereo_measure FOLDER   (leftNN.jpg and rightNN.jpg)\n");
    return 2;
  }
  return rigcal::Measure(argv[1]);
}
