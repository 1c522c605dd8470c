#include "server/calib/motion/hand_eye_work.h"

#include <algorithm>
#include <cmath>

#include "server/calib/core/selection.h"

namespace rigcal::calib {
namespace {

// What a tracker or a robot is taken to be good for until its residuals say.
constexpr double kTrackerSigma_m = 0.001, kTrackerSigma_rad = 0.001;
// Poses of the body that are as near as this are one pose.
constexpr double kDriftSigma_m = 0.05;  // of a stream's world
constexpr double kSamePose_m = 0.0005, kSamePose_rad = 0.0005;

std::vector<PoseCandidate> CandidatesOf(const CameraMotion& camera, const CaptureId& capture) {
  std::vector<PoseCandidate> candidates;
  const std::vector<ViewMoments>& views = camera.views.at(capture);
  const double variance_px2 = std::max(camera.camera.variance_px2, 1e-6);
  for (const ViewMoments& view : views)
    for (int turn = 0; turn < camera.turns; ++turn)
      candidates.push_back(
          {PoseOf(camera, view, turn), std::max(0.0, view.ssr_px2 - views.front().ssr_px2) / variance_px2, turn == 0});
  return candidates;
}

std::vector<PoseCandidate> CandidatesOf(const TimedPose& row) {
  PoseCandidate candidate;
  candidate.pose.T_world_sensor = row.T_world_body;
  candidate.pose.covariance =
      EachAxis(kTrackerSigma_m * kTrackerSigma_m, kTrackerSigma_rad * kTrackerSigma_rad).asDiagonal();
  return {candidate};
}

using CandidateMap = std::map<CaptureId, std::vector<PoseCandidate>>;

OrDiagnosis<CandidateMap> CandidatesOf(const HandEyeProblem& problem, const HandEyeSide& side,
                                       std::optional<CameraMotion>& camera, std::map<CaptureId, std::string>& unused) {
  CandidateMap candidates;
  if (side.sensor.kind != SensorKind::kCamera) {
    for (const TimedPose& row : side.poses) candidates[row.capture] = CandidatesOf(row);
    return candidates;
  }
  auto motion = CameraMotionOf({side.sensor, *side.board, side.views}, problem.solve_camera);
  if (!motion) return tl::unexpected(CameraFailed(problem, side, motion.error()));
  camera = std::move(*motion);
  for (const auto& [capture, why] : camera->camera.unused) unused[capture] = side.sensor.id.str() + ": " + why;
  for (const auto& [capture, views] : camera->views) candidates[capture] = CandidatesOf(*camera, capture);
  return candidates;
}

const BoardView* ViewOf(const HandEyeSide& side, const CaptureId& capture) {
  const auto at = std::lower_bound(side.views.begin(), side.views.end(), capture,
                                   [](const auto& view, const CaptureId& id) { return view.first < id; });
  return at != side.views.end() && at->first == capture ? &at->second : nullptr;
}

bool IsRepeat(const HandEyeSide& side, const CandidateMap& candidates, const CaptureId& x, const CaptureId& y) {
  if (side.board) {
    const BoardView *view_x = ViewOf(side, x), *view_y = ViewOf(side, y);
    return view_x && view_y && ShowSame(*view_x, *view_y, *side.board);
  }
  return AreNear(candidates.at(x)[0].pose.T_world_sensor, candidates.at(y)[0].pose.T_world_sensor, kSamePose_m,
                 kSamePose_rad);
}

SidePose Scaled(SidePose pose, const SideFactor& factor) {
  const Vector6d scale = EachAxis(std::sqrt(factor.translation), std::sqrt(factor.rotation));
  pose.covariance = scale.asDiagonal() * pose.covariance * scale.asDiagonal();
  return pose;
}

// By what the poses share beyond what is known of: apart from the motion nothing tells it.
void Widen(MotionSide& side) {
  const Eigen::Index count = side.poses.front().d_shared.cols();
  side.information.conservativeResizeLike(SharedMatrix::Zero(count, count));
  side.gradient.conservativeResizeLike(SharedVector::Zero(count));
}

}  // namespace

OrDiagnosis<HandEyeWork> CollectMotion(const HandEyeProblem& problem) {
  HandEyeWork work;
  RIGCAL_ASSIGN(const auto a, CandidatesOf(problem, problem.a, work.camera_a, work.unused));
  RIGCAL_ASSIGN(const auto b, CandidatesOf(problem, problem.b, work.camera_b, work.unused));
  std::set<CaptureId> all;
  for (const auto* side : {&a, &b})
    for (const auto& [capture, candidates] : *side) all.insert(capture);
  std::size_t repeated = 0;
  for (const CaptureId& capture : all) {
    const auto of_a = a.find(capture), of_b = b.find(capture);
    if (of_a == a.end() || of_b == b.end()) {
      work.unused.emplace(capture, (of_a == a.end() ? problem.a : problem.b).sensor.id.str() + " has no pose");
      continue;
    }
    const auto earlier = std::find_if(work.captures.begin(), work.captures.end(), [&](const CaptureId& other) {
      return IsRepeat(problem.a, a, other, capture) && IsRepeat(problem.b, b, other, capture);
    });
    if (earlier != work.captures.end()) {
      ++repeated;
      work.unused.emplace(capture, "shows the same as " + earlier->str());
      continue;
    }
    work.captures.push_back(capture);
    work.candidates.push_back({of_a->second, of_b->second});
  }
  if (work.captures.size() < kHandEyeMin) return tl::unexpected(TooFewMotions(problem, work.captures.size(), repeated));
  return work;
}

void SetShared(const HandEyeWork& work, const std::set<CaptureId>& without, MotionProblem& problem) {
  const auto fill = [&](const std::optional<CameraMotion>& camera, std::size_t MotionChoice::*choice, double factor,
                        MotionSide& side) {
    if (!camera) return;
    std::map<CaptureId, std::size_t> chosen;
    for (std::size_t k = 0; k < work.captures.size(); ++k)
      chosen[work.captures[k]] = work.choices[k].*choice / static_cast<std::size_t>(camera->turns);
    FillShared(*camera, chosen, without, factor, side);
  };
  fill(work.camera_a, &MotionChoice::a, work.factor_a.translation, problem.a);
  fill(work.camera_b, &MotionChoice::b, work.factor_b.translation, problem.b);
  if (work.asked == Asked::kBoardSizeA) Widen(problem.a);
  if (work.asked == Asked::kBoardSizeB) Widen(problem.b);
  if (work.asked != Asked::kClockOffset) return;
  // A drift is small until the poses say otherwise; of the offset nothing is known.
  problem.b.information = SharedMatrix::Zero(kStreamShared, kStreamShared);
  problem.b.information.diagonal().head<3>().setConstant(1 / (kDriftSigma_m * kDriftSigma_m));
  problem.b.gradient = SharedVector::Zero(kStreamShared);
}

MotionNoise NoiseOf(std::initializer_list<const MotionSide*> sides, const std::vector<char>& used) {
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  double count = 0;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (!used[k]) continue;
    for (const MotionSide* side : sides)
      variance += Eigen::Vector2d(side->poses[k].covariance.topLeftCorner<3, 3>().trace() / 3,
                                  side->poses[k].covariance.bottomRightCorner<3, 3>().trace() / 3);
    count += 1;
  }
  return {std::sqrt(variance[0] / std::max(1.0, count)), std::sqrt(variance[1] / std::max(1.0, count))};
}

double AskedOf(const HandEyeWork& work, const MotionState& state) {
  if (work.asked == Asked::kNothing) return 0.0;
  const SharedVector& shared = work.asked == Asked::kBoardSizeA ? state.shared_a : state.shared_b;
  return shared[shared.size() - 1];
}

namespace {

constexpr int kRoundsMax = 40, kChoosingRounds = 6;
constexpr int kIterationsOnTheWay = 4;
constexpr double kSamePath_ratio = 0.01;                       // of a factor from round to round
constexpr double kGateSquares = 40.0;                          // of six degrees of freedom: one in a million
constexpr double kChiMedian = 5.35;                            // of six degrees of freedom
constexpr double kFewPoses = 5.0;                              // Rousseeuw & Leroy (1987)
constexpr double kPriorOfCamera = 2.0, kPriorOfTracker = 0.5;  // squares that the expected noise counts as
constexpr double kFactorMin = 1e-8;
// Errors of a stream last for many of its poses and do not average out as those of captures do.
constexpr double kStreamNoises = 8.0;

std::vector<MotionCandidates> ScaledCandidates(const HandEyeWork& work) {
  std::vector<MotionCandidates> scaled = work.candidates;
  for (MotionCandidates& capture : scaled) {
    for (PoseCandidate& candidate : capture.a) candidate.pose = Scaled(candidate.pose, work.factor_a);
    for (PoseCandidate& candidate : capture.b) candidate.pose = Scaled(candidate.pose, work.factor_b);
  }
  return scaled;
}

void SetChosen(const std::vector<MotionCandidates>& scaled, HandEyeWork& work) {
  std::vector<char> used = std::move(work.problem.used);
  work.problem = ProblemOf(scaled, work.choices);
  if (used.size() == work.problem.used.size()) work.problem.used = std::move(used);
  SetShared(work, {}, work.problem);
}

double UpdatedFactor(double factor, double squares, double redundancy, double prior) {
  return std::max(kFactorMin, (prior + factor * squares) / (prior + std::max(redundancy, 0.0)));
}

// Of a camera both parts move together; redundancy says how much of a residual is not taken up by the unknowns.
SideFactor Updated(const SideFactor& factor, const SideFit& fit, bool camera) {
  if (camera) {
    const double both = UpdatedFactor(factor.translation, fit.squares[0] + fit.squares[1],
                                      fit.redundancy[0] + fit.redundancy[1], kPriorOfCamera);
    return {both, both};
  }
  return {UpdatedFactor(factor.translation, fit.squares[0], fit.redundancy[0], kPriorOfTracker),
          UpdatedFactor(factor.rotation, fit.squares[1], fit.redundancy[1], kPriorOfTracker)};
}

bool Same(const SideFactor& x, const SideFactor& y) {
  return std::abs(x.translation / y.translation - 1) < kSamePath_ratio &&
         std::abs(x.rotation / y.rotation - 1) < kSamePath_ratio;
}

// Which poses contradict the others: judged by the middle of all, so that they cannot hide in their own noise.
std::vector<char> Gated(const HandEyeWork& work) {
  std::vector<double> squares;
  for (std::size_t k = 0; k < work.problem.used.size(); ++k) {
    const Vector6d r = MotionResidual(work.problem, work.state, k);
    squares.push_back(r.dot(ResidualCovariance(work.problem, work.state.X, k).llt().solve(r)));
  }
  std::vector<double> sorted = squares;
  std::sort(sorted.begin(), sorted.end());
  // Of few poses the middle lies too close, as the solution leans on them.
  const double few = 1 + kFewPoses / static_cast<double>(sorted.size() - 2);
  const double limit = kGateSquares * few * few * std::max(1.0, sorted[sorted.size() / 2] / kChiMedian);
  std::vector<char> used;
  for (const double value : squares) used.push_back(value <= limit);
  return used;
}

// What the motion leaves open is not what the noise made of it, but what the drawing says, or nothing.
void HoldOpen(const HandEyeProblem& problem, HandEyeWork& work) {
  work.problem.free = work.reach.free;
  if (work.reach.open.cols() == 0) return;
  const Se3 wanted = problem.T_a_b_nominal.value_or(Se3{Eigen::Vector3d::Zero(), work.state.X.q});
  const Vector6d away = (work.state.X.Inverse() * wanted).Log();
  // Without a drawing only positions have a natural value, nearest to a; they are the first of the open columns.
  const Eigen::Index positions = work.reach.kind == MotionKind::kOnTheSpot ? 1 : 3;
  const Eigen::MatrixXd open = work.reach.open.leftCols(
      problem.T_a_b_nominal ? work.reach.open.cols() : std::min(positions, work.reach.open.cols()));
  work.state.X = (work.state.X * Se3::Exp(open * (open.transpose() * away))).Normalized();
  // Z follows, or the held part would pull at it through the noise.
  for (std::size_t k = 0; k < work.problem.used.size(); ++k) {
    if (!work.problem.used[k]) continue;
    work.state.Z = work.state.T_world_a[k] * work.state.X * work.problem.b.poses[k].T_world_sensor.Inverse();
    break;
  }
}

void FindReach(const HandEyeProblem& problem, HandEyeWork& work) {
  std::vector<Se3> used;
  for (std::size_t k = 0; k < work.problem.used.size(); ++k)
    if (work.problem.used[k]) used.push_back(work.state.T_world_a[k]);
  const MotionKind before = work.reach.kind;
  const bool first = work.reach.free.cols() == 0;
  MotionNoise noise = NoiseOf({&work.problem.a, &work.problem.b}, work.problem.used);
  if (work.asked == Asked::kClockOffset) noise.noises = kStreamNoises;
  work.reach = ObservableByMotion(used, work.state.X, noise);
  if (first || work.reach.kind != before)
    HoldOpen(problem, work);
  else
    work.problem.free = work.reach.free;
}

OrDiagnosis<void> SolveRound(const HandEyeProblem& problem, HandEyeWork& work, int iterations_max) {
  if (work.reach.kind == MotionKind::kStill) return tl::unexpected(NoMotion(problem));
  const auto solution = SolveMotion(work.problem, work.state, {.iterations_max = iterations_max});
  if (!solution) return tl::unexpected(MotionNotSolvable(problem, solution.error()));
  work.state = solution->state;
  auto fit = FitOf(work.problem, work.state);
  if (!fit) return tl::unexpected(MotionNotSolvable(problem, fit.error()));
  work.fit = std::move(*fit);
  return {};
}

// One look at choices and contradictions; false where nothing changed.
bool Reconsider(HandEyeWork& work) {
  const std::vector<MotionCandidates> scaled = ScaledCandidates(work);
  std::vector<MotionChoice> choices = ChooseUnder(scaled, work.state.X, work.state.Z).choices;
  const bool same_choices =
      std::equal(choices.begin(), choices.end(), work.choices.begin(),
                 [](const MotionChoice& x, const MotionChoice& y) { return x.a == y.a && x.b == y.b; });
  for (std::size_t k = 0; k < choices.size(); ++k)
    if (choices[k].a != work.choices[k].a) work.state.T_world_a[k] = scaled[k].a[choices[k].a].pose.T_world_sensor;
  work.choices = std::move(choices);
  SetChosen(scaled, work);
  std::vector<char> used = Gated(work);
  const bool same_used = used == work.problem.used;
  work.problem.used = std::move(used);
  return !(same_choices && same_used);
}

OrDiagnosis<void> StartFit(const HandEyeProblem& problem, HandEyeWork& work) {
  auto consensus = FindConsensus(work.candidates, problem.T_a_b_nominal);
  if (!consensus) return tl::unexpected(MotionsContradict(problem, work.captures.size()));
  work.choices = consensus->choices;
  SetChosen(work.candidates, work);
  work.state = StateFrom(work.problem, consensus->X, consensus->Z);
  work.problem.used = Gated(work);
  return {};
}

// The same X, Z, noise and choices with poses that were looked up anew.
void Restart(HandEyeWork& work) {
  work.choices.assign(work.captures.size(), {});
  const auto free = work.problem.free;
  work.problem.used.assign(work.captures.size(), 1);
  SetChosen(ScaledCandidates(work), work);
  work.problem.free = free;
  work.state = StateFrom(work.problem, work.state.X, work.state.Z);
  work.problem.used = Gated(work);
}

}  // namespace

OrDiagnosis<void> FitMotion(const HandEyeProblem& problem, HandEyeWork& work) {
  if (work.choices.empty()) {
    if (auto started = StartFit(problem, work); !started) return started;
  } else {
    Restart(work);
  }
  for (int round = 0; round < kRoundsMax; ++round) {
    FindReach(problem, work);
    if (auto solved = SolveRound(problem, work, kIterationsOnTheWay); !solved) return solved;
    const SideFactor a = Updated(work.factor_a, work.fit.a, work.camera_a.has_value()),
                     b = Updated(work.factor_b, work.fit.b, work.camera_b.has_value());
    const bool same_noise = Same(a, work.factor_a) && Same(b, work.factor_b);
    work.factor_a = a;
    work.factor_b = b;
    bool changed = false;
    if (round < kChoosingRounds)
      changed = Reconsider(work);
    else
      SetChosen(ScaledCandidates(work), work);
    work.problem.free = work.reach.free;
    if (work.problem.UsedCount() < kHandEyeMin) return tl::unexpected(MotionsContradict(problem, work.captures.size()));
    if (same_noise && !changed) break;
  }
  return SolveRound(problem, work, kMotionIterationsMax);
}

}  // namespace rigcal::calib
