#include "server/calib/motion/motion_consensus.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "server/calib/core/robust.h"
#include "server/calib/motion/motion_start.h"

namespace rigcal::calib {
namespace {

constexpr int kSamplesMax = 150, kSamplesMin = 12, kRefinementsMax = 4;
constexpr std::size_t kTriplesAll = 8;                // with so few captures every triple is tried
constexpr std::size_t kKept = 3;                      // partners of a sample, and combinations of them
constexpr double kGoodMedian = 9.0;                   // of squares with six degrees of freedom: noise explains it
constexpr double kAngle_rad = 0.01, kPitch_m = 0.02;  // how well a sample's screws should agree
constexpr double kInlierMedians = 6.0, kInlierLeast = 20.0;

// Choices of capture `k` under X and Z; stops looking where a residual is plainly large.
MotionChoice BestChoice(const MotionCandidates& capture, const Se3& X, const Se3& Z, const Matrix6d& M) {
  MotionChoice best{0, 0, std::numeric_limits<double>::infinity()};
  const Se3 Z_inverse = Z.Inverse();
  for (std::size_t i = 0; i < capture.a.size(); ++i) {
    const Se3 W = Z_inverse * capture.a[i].pose.T_world_sensor * X;
    const Matrix6d C_a = M * capture.a[i].pose.covariance * M.transpose();
    for (std::size_t j = 0; j < capture.b.size(); ++j) {
      const Vector6d r = (capture.b[j].pose.T_world_sensor.Inverse() * W).Log();
      const Matrix6d S = C_a + capture.b[j].pose.covariance;
      const double squares = r.dot(S.llt().solve(r)) + capture.a[i].penalty + capture.b[j].penalty;
      if (squares < best.squares) best = {i, j, squares};
    }
  }
  return best;
}

// The median, or infinity as soon as it is beyond `limit`.
double Score(const std::vector<MotionCandidates>& captures, const Se3& X, const Se3& Z, double limit) {
  const Matrix6d M = Adjoint(X.Inverse());
  std::vector<double> squares;
  std::size_t beyond = 0;
  for (const MotionCandidates& capture : captures) {
    squares.push_back(BestChoice(capture, X, Z, M).squares);
    if (!(squares.back() < limit) && 2 * ++beyond > captures.size()) return std::numeric_limits<double>::infinity();
  }
  return MedianOf(std::move(squares));
}

struct Hypothesis {
  Se3 X, Z;
  double median = std::numeric_limits<double>::infinity();
};

MotionPair PairOf(const MotionCandidates& from, const MotionCandidates& to, const MotionChoice& i,
                  const MotionChoice& j) {
  return {from.a[i.a].pose.T_world_sensor.Inverse() * to.a[j.a].pose.T_world_sensor,
          from.b[i.b].pose.T_world_sensor.Inverse() * to.b[j.b].pose.T_world_sensor};
}

// Two sensors of one body make the same screw: by the same angle, and the same way along its axis.
double ScrewDifference(const MotionPair& motion) {
  const Vector6d a = motion.A.Log(), b = motion.B.Log();
  const double angle_a = a.tail<3>().norm(), angle_b = b.tail<3>().norm();
  double difference = std::pow((angle_a - angle_b) / kAngle_rad, 2);
  if (angle_a > kAngle_rad && angle_b > kAngle_rad)
    difference +=
        std::pow((motion.A.p_m.dot(a.tail<3>()) / angle_a - motion.B.p_m.dot(b.tail<3>()) / angle_b) / kPitch_m, 2);
  return difference;
}

std::vector<MotionChoice> AllChoices(const MotionCandidates& capture, bool as_found_only) {
  std::vector<MotionChoice> choices;
  for (std::size_t i = 0; i < capture.a.size(); ++i)
    for (std::size_t j = 0; j < capture.b.size(); ++j)
      if (!as_found_only || (capture.a[i].as_found && capture.b[j].as_found))
        choices.push_back({i, j, capture.a[i].penalty + capture.b[j].penalty});
  return choices;
}

void KeepBest(std::vector<MotionChoice>& choices) {
  std::stable_sort(choices.begin(), choices.end(),
                   [](const MotionChoice& x, const MotionChoice& y) { return x.squares < y.squares; });
  if (choices.size() > kKept) choices.resize(kKept);
}

class Search {
 public:
  explicit Search(const std::vector<MotionCandidates>& captures) : captures_(captures) {}

  void Try(const std::array<std::size_t, 3>& sample) {
    for (const MotionChoice& first : AllChoices(captures_[sample[0]], true)) {
      const auto second = Partners(sample[0], first, sample[1]), third = Partners(sample[0], first, sample[2]);
      for (const MotionChoice& j : second)
        for (const MotionChoice& l : third) TryMotions(sample, {first, j, l});
    }
  }

  void TryPose(const Se3& X, const MotionPair& poses) {
    const Se3 Z = poses.A * X * poses.B.Inverse();
    const double median = Score(captures_, X, Z, best_.median);
    if (median < best_.median) best_ = {X, Z, median};
  }

  [[nodiscard]] const Hypothesis& best() const { return best_; }

 private:
  std::vector<MotionChoice> Partners(std::size_t from, const MotionChoice& first, std::size_t to) const {
    std::vector<MotionChoice> choices = AllChoices(captures_[to], false);
    for (MotionChoice& choice : choices)
      choice.squares += ScrewDifference(PairOf(captures_[from], captures_[to], first, choice));
    KeepBest(choices);
    return choices;
  }

  void TryMotions(const std::array<std::size_t, 3>& sample, const std::array<MotionChoice, 3>& choices) {
    std::vector<MotionPair> motions;
    for (const auto& [i, j] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
      motions.push_back(PairOf(captures_[sample[static_cast<std::size_t>(i)]],
                               captures_[sample[static_cast<std::size_t>(j)]], choices[static_cast<std::size_t>(i)],
                               choices[static_cast<std::size_t>(j)]));
    const MotionCandidates& first = captures_[sample[0]];
    for (const Se3& X : StartsOf(motions))
      TryPose(X, {first.a[choices[0].a].pose.T_world_sensor, first.b[choices[0].b].pose.T_world_sensor});
  }

  const std::vector<MotionCandidates>& captures_;
  Hypothesis best_;
};

std::vector<std::array<std::size_t, 3>> SamplesOf(std::size_t count) {
  std::vector<std::array<std::size_t, 3>> samples;
  if (count <= kTriplesAll) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = i + 1; j < count; ++j)
        for (std::size_t l = j + 1; l < count; ++l) samples.push_back({i, j, l});
    return samples;
  }
  std::minstd_rand random(1);  // its numbers are fixed by the standard
  while (samples.size() < kSamplesMax) {
    const std::size_t i = random() % count, j = random() % count, l = random() % count;
    if (i != j && i != l && j != l) samples.push_back({i, j, l});
  }
  return samples;
}

// From the closed form over the captures that agree, if that agrees better.
MotionConsensus FromClosedForm(const std::vector<MotionCandidates>& captures, const MotionProblem& problem,
                               const MotionConsensus& from) {
  std::vector<Se3> a, b;
  for (std::size_t k = 0; k < captures.size(); ++k) {
    if (!problem.used[k]) continue;
    a.push_back(problem.a.poses[k].T_world_sensor);
    b.push_back(problem.b.poses[k].T_world_sensor);
  }
  const ClosedForm closed = ClosedFormOf(a, b);
  const MotionConsensus candidate = ChooseUnder(captures, closed.X, closed.Z);
  return candidate.median < from.median ? candidate : from;
}

// Solved over the captures that agree with it.
std::optional<MotionConsensus> Refined(const std::vector<MotionCandidates>& captures, const MotionConsensus& before) {
  MotionProblem problem = ProblemOf(captures, before.choices);
  const double limit = std::max(kInlierLeast, kInlierMedians * before.median);
  for (std::size_t k = 0; k < captures.size(); ++k) problem.used[k] = before.choices[k].squares <= limit;
  const MotionConsensus from = FromClosedForm(captures, problem, before);
  const auto solution = SolveMotion(problem, StateFrom(problem, from.X, from.Z));
  if (!solution) return std::nullopt;
  return ChooseUnder(captures, solution->state.X, solution->state.Z);
}

}  // namespace

MotionConsensus ChooseUnder(const std::vector<MotionCandidates>& captures, const Se3& X, const Se3& Z) {
  MotionConsensus consensus{X, Z, {}, 0.0};
  const Matrix6d M = Adjoint(X.Inverse());
  std::vector<double> squares;
  for (const MotionCandidates& capture : captures) {
    consensus.choices.push_back(BestChoice(capture, X, Z, M));
    squares.push_back(consensus.choices.back().squares);
  }
  consensus.median = MedianOf(std::move(squares));
  return consensus;
}

MotionProblem ProblemOf(const std::vector<MotionCandidates>& captures, const std::vector<MotionChoice>& choices) {
  MotionProblem problem;
  for (std::size_t k = 0; k < captures.size(); ++k) {
    problem.a.poses.push_back(captures[k].a[choices[k].a].pose);
    problem.b.poses.push_back(captures[k].b[choices[k].b].pose);
    problem.used.push_back(1);
  }
  return problem;
}

std::optional<MotionConsensus> FindConsensus(const std::vector<MotionCandidates>& captures,
                                             const std::optional<Se3>& nominal) {
  if (captures.size() < 3) return std::nullopt;
  Search search(captures);
  if (nominal)
    for (const MotionCandidates& capture : captures)
      search.TryPose(*nominal, {capture.a[0].pose.T_world_sensor, capture.b[0].pose.T_world_sensor});
  int tried = 0;
  for (const auto& sample : SamplesOf(captures.size())) {
    search.Try(sample);
    if (++tried >= kSamplesMin && search.best().median < kGoodMedian) break;
  }
  if (!std::isfinite(search.best().median)) return std::nullopt;
  MotionConsensus consensus = ChooseUnder(captures, search.best().X, search.best().Z);
  for (int round = 0; round < kRefinementsMax; ++round) {
    const auto refined = Refined(captures, consensus);
    if (!refined || !(refined->median <= consensus.median)) break;
    const bool done = refined->median > 0.999 * consensus.median;
    consensus = *refined;
    if (done) break;
  }
  return consensus;
}

}  // namespace rigcal::calib
