#include "server/calib/motion/local_path.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

namespace rigcal::calib {
namespace {

constexpr double kNanoseconds = 1e-9;
constexpr int kTermsMax = 4, kRowsOfTerm = 2;  // at least two rows for each coefficient
constexpr std::size_t kRowsMin = 4;

struct Sample {
  double u = 0.0;  // time since the middle, in halves of the span
  Vector6d xi = Vector6d::Zero();
};

std::vector<Sample> SamplesOf(const PoseTable& path, Stamp instant, const Se3& T_told, double about_s) {
  const auto since_s = [&](const TimedPose& row) {
    return kNanoseconds * static_cast<double>(row.stamp.ns - instant.ns) - about_s;
  };
  const Se3 from_told = T_told.Inverse();
  std::vector<Sample> samples;
  for (auto row = std::lower_bound(path.begin(), path.end(), -kLocalPathHalf_s,
                                   [&](const TimedPose&one, double t_s) { return since_s(one) < t_s; });
       row != path.end() && since_s(*row) <= kLocalPathHalf_s; ++row)
    samples.push_back({since_s(*row) / kLocalPathHalf_s, (from_told * row->T_world_body).Log()});
  return samples;
}

// Rows on both sides, none far from the next.
bool Encloses(const std::vector<Sample>& samples) {
  if (samples.size() < kRowsMin || samples.front().u >= 0 || samples.back().u <= 0) return false;
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (samples[i].u - samples[i - 1].u > 1.0) return false;
  return true;
}

// As the samples have it; it need not go through T_told.
std::optional<LocalPathFit> FitSamples(const std::vector<Sample>& samples, double about_s) {
  if (!Encloses(samples)) return std::nullopt;
  const auto rows = static_cast<Eigen::Index>(samples.size());
  const Eigen::Index terms = std::min<Eigen::Index>(kTermsMax, rows / kRowsOfTerm);
  Eigen::MatrixXd X(rows, terms), Y(rows, 6);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Sample& sample = samples[static_cast<std::size_t>(i)];
    for (Eigen::Index power = 0; power < terms; ++power) X(i, power) = std::pow(sample.u, static_cast<double>(power));
    Y.row(i) = sample.xi.transpose();
  }
  const Eigen::MatrixXd coefficients = X.colPivHouseholderQr().solve(Y);
  const Eigen::MatrixXd left = Y - X * coefficients;
  LocalPathFit fit;
  fit.path.about_s = about_s;
  for (Eigen::Index power = 0; power < terms; ++power)
    fit.path.by_power.col(power) =
        coefficients.row(power).transpose() / std::pow(kLocalPathHalf_s, static_cast<double>(power));
  fit.squares << left.leftCols<3>().squaredNorm(), left.rightCols<3>().squaredNorm();
  fit.redundancy = 3.0 * static_cast<double>(rows - terms);
  const Eigen::MatrixXd normal = X.transpose() * X;
  fit.velocity_gain_per_s2 = normal.inverse()(1, 1) / (kLocalPathHalf_s * kLocalPathHalf_s);
  return fit;
}

// The polynomial and its derivative.
struct Curve {
  Vector6d xi, slope;
};
Curve CurveAt(const LocalPath& path, double t_s) {
  const double since_s = t_s - path.about_s, within_s = std::clamp(since_s, -kLocalPathHalf_s, kLocalPathHalf_s);
  Curve at{path.by_power.col(3), Vector6d::Zero()};
  for (int power = 2; power >= 0; --power) {
    at.slope = at.slope * within_s + at.xi;
    at.xi = at.xi * within_s + path.by_power.col(power);
  }
  at.xi += at.slope * (since_s - within_s);
  return at;
}

}  // namespace

Se3 LocalPath::StepTo(double t_s) const { return Se3::Exp(CurveAt(*this, t_s).xi); }

Vector6d LocalPath::TwistAt(double t_s) const {
  const Curve at = CurveAt(*this, t_s);
  return RightJacobian(at.xi) * at.slope;
}

std::optional<LocalPathFit> FitLocalPath(const PoseTable& path, Stamp instant, const Se3& T_told, double about_s) {
  auto fit = FitSamples(SamplesOf(path, instant, T_told, about_s), about_s);
  if (!fit) return std::nullopt;
  // By how much the curve misses what is told for the instant itself: noise of that one row.
  const auto at_instant = about_s == 0 ? fit : FitSamples(SamplesOf(path, instant, T_told, 0.0), 0.0);
  if (at_instant) fit->path.by_power.col(0) -= at_instant->path.by_power.col(0).eval();
  return fit;
}

}  // namespace rigcal::calib
