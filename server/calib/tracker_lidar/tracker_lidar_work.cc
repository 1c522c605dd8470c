#include "server/calib/tracker_lidar/tracker_lidar_work.h"

#include <algorithm>
#include <cmath>

#include "server/calib/core/leave_one_out.h"
#include "server/calib/core/robust.h"

namespace rigcal::calib {
namespace {

// What a tracker is taken to be good for until its residuals say.
constexpr double kTrackerSigma_m = 0.001, kTrackerSigma_rad = 0.001;
// Poses of the body that are as near as this are one pose.
constexpr double kSamePose_m = 0.0005, kSamePose_rad = 0.0005;
constexpr double kFlatness_m = 0.001;  // no board is flatter, however exact the lidar
constexpr double kSamePatch_m = 0.15, kSamePatchCosine = 0.97;
constexpr std::size_t kCapturesPerBoardPart = 5;  // a board is seen in a fifth of the captures, or it is no board
constexpr double kOtherRatio = 0.8;
constexpr int kRoundsMax = 40, kRejectionsMax = 6, kIterationsOnTheWay = 5;
constexpr double kSame_ratio = 0.01;   // of a factor from round to round
constexpr double kPriorSquares = 0.5;  // that the expected noise counts as
constexpr double kFactorMin = 1e-8;

// Their order must not show.
std::vector<std::size_t> ById(const TrackerLidarProblem& problem) {
  std::vector<std::size_t> order(problem.captures.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return problem.captures[i].capture < problem.captures[j].capture; });
  return order;
}

std::string WhyUseless(const TrackerLidarProblem& problem, const TrackerLidarCapture& capture) {
  if (!capture.T_world_body) return problem.tracker.id.str() + " has no pose";
  const std::string beam = problem.lidar.id.str() + ": ";
  if (capture.clouds.empty()) return beam + "no cloud";
  if (PatchesOf(capture).empty()) return beam + capture.clouds.front().why_not;
  return {};
}

// Body poses in a world whose origin is among them: numbers stay small wherever the tracker's own is.
std::vector<Se3> CentredPoses(const TrackerLidarProblem& problem, const std::vector<std::size_t>& captures) {
  std::vector<Se3> poses;
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const std::size_t idx : captures) {
    poses.push_back(*problem.captures[idx].T_world_body);
    mean_m += poses.back().p_m / static_cast<double>(captures.size());
  }
  for (Se3& pose : poses) pose.p_m -= mean_m;
  return poses;
}

std::vector<PlacedPatches> PlacedIn(const TrackerLidarProblem& problem, const std::vector<std::size_t>& captures,
                                    const std::vector<Se3>& poses) {
  std::vector<PlacedPatches> placed;
  for (std::size_t k = 0; k < captures.size(); ++k) {
    placed.push_back({poses[k], {}});
    for (const PlanePatch* patch : PatchesOf(problem.captures[captures[k]]))
      placed.back().patches.push_back({patch->normal, patch->centre_m});
  }
  return placed;
}

void TakeConsensus(const TrackerLidarProblem& problem, const PlaneConsensus& consensus,
                   const std::vector<std::size_t>& captures, const std::vector<Se3>& poses, TrackerLidarWork& work) {
  work.state.T_body_lidar = consensus.T_body_lidar;
  for (const BoardPlane& board : consensus.boards)
    work.state.planes.push_back({board.normal, board.normal.dot(board.centre_m)});
  for (std::size_t k = 0; k < captures.size(); ++k) {
    const std::vector<const PlanePatch*> patches = PatchesOf(problem.captures[captures[k]]);
    std::vector<ChosenPatch> chosen;
    for (std::size_t i = 0; i < patches.size(); ++i)
      if (consensus.board_of_patch[k][i]) chosen.push_back({patches[i], *consensus.board_of_patch[k][i]});
    if (chosen.empty()) {
      work.unused[captures[k]] = "no patch of its cloud is where a board stands in the other captures";
      work.contradicting.push_back(captures[k]);
      continue;
    }
    work.captures.push_back(captures[k]);
    work.patches.push_back(std::move(chosen));
    work.state.T_world_body.push_back(poses[k]);
  }
}

Matrix6d CovarianceOf(const TrackerLidarWork& work) {
  return EachAxis(work.factor_translation * kTrackerSigma_m * kTrackerSigma_m,
                  work.factor_rotation * kTrackerSigma_rad * kTrackerSigma_rad)
      .asDiagonal();
}

PlaneMoments WeighedMoments(const PlanePatch& patch, double range_sigma_m) {
  PlaneMoments moments = MomentsOf(patch, range_sigma_m);
  const double factor = std::min(1.0, std::pow(range_sigma_m / kFlatness_m, 2));
  moments.sum *= factor;
  moments.weight_per_m2 *= factor;
  return moments;
}

void FillMoments(TrackerLidarWork& work) {
  std::vector<const PlanePatch*> all;
  for (const auto& patches : work.patches)
    for (const ChosenPatch& chosen : patches) all.push_back(chosen.patch);
  work.range_sigma_m = RangeSigma_m(all);
  for (std::size_t k = 0; k < work.patches.size(); ++k) {
    work.problem.captures[k].seen.clear();
    for (const ChosenPatch& chosen : work.patches[k])
      work.problem.captures[k].seen.push_back({chosen.board_idx, WeighedMoments(*chosen.patch, work.range_sigma_m)});
  }
}

void SetProblem(const TrackerLidarProblem& problem, TrackerLidarWork& work) {
  work.problem.range_bias_m = problem.range_bias_m;
  for (const Se3& pose : work.state.T_world_body) work.problem.captures.push_back({pose, CovarianceOf(work), {}});
  FillMoments(work);
}

OrDiagnosis<void> Solve(const TrackerLidarProblem& problem, TrackerLidarWork& work, int iterations_max) {
  for (StaticCapture& capture : work.problem.captures) capture.covariance = CovarianceOf(work);
  auto solution = SolveStatic(work.problem, work.state, iterations_max);
  if (!solution) return tl::unexpected(TrackerLidarNotSolvable(problem, solution.error()));
  work.state = std::move(solution->state);
  auto fit = FitOf(work.problem, work.state);
  if (!fit) return tl::unexpected(TrackerLidarNotSolvable(problem, fit.error()));
  work.fit = std::move(*fit);
  return {};
}

// Without a drawing only positions have a natural value, nearest to the body.
Eigen::MatrixXd OpenPositions(const TrackerLidarWork& work) {
  const std::vector<Eigen::Vector3d> positions = AxesOf(work.reach, work.state.T_body_lidar).positions;
  Eigen::MatrixXd open = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i)
    open.col(static_cast<Eigen::Index>(i)).head<3>() = work.state.T_body_lidar.R().transpose() * positions[i];
  return open;
}

// What the motion leaves open is not what the noise made of it, but what the drawing says, or nothing.
void HoldOpen(const TrackerLidarProblem& problem, TrackerLidarWork& work) {
  work.problem.free = work.reach.free;
  if (work.reach.open.cols() == 0) return;
  const Se3& X = work.state.T_body_lidar;
  const Se3 wanted = problem.T_body_lidar_nominal.value_or(Se3{Eigen::Vector3d::Zero(), X.q});
  const Eigen::MatrixXd open = problem.T_body_lidar_nominal ? Eigen::MatrixXd(work.reach.open) : OpenPositions(work);
  const Vector6d away = (X.Inverse() * wanted).Log();
  work.state.T_body_lidar = (X * Se3::Exp(open * (open.transpose() * away))).Normalized();
}

double Updated(double factor, double squares, double redundancy) {
  return std::max(kFactorMin, (kPriorSquares + factor * squares) / (kPriorSquares + std::max(redundancy, 0.0)));
}

bool UpdateNoise(TrackerLidarWork& work) {
  const double translation = Updated(work.factor_translation, work.fit.squares[0], work.fit.redundancy[0]);
  const double rotation = Updated(work.factor_rotation, work.fit.squares[1], work.fit.redundancy[1]);
  const bool same = std::abs(translation / work.factor_translation - 1) < kSame_ratio &&
                    std::abs(rotation / work.factor_rotation - 1) < kSame_ratio;
  work.factor_translation = translation;
  work.factor_rotation = rotation;
  return !same;
}

// As the noise shrinks from round to round more may be told; what was held stays where it was put.
void FindReach(const TrackerLidarProblem& problem, TrackerLidarWork& work) {
  const Eigen::Index before = work.reach.open.cols();
  const bool first = work.reach.free.cols() + before == 0;
  for (StaticCapture& capture : work.problem.captures) capture.covariance = CovarianceOf(work);
  work.reach = ObservableByPlanes(work.problem, work.state);
  if (first || work.reach.open.cols() != before)
    HoldOpen(problem, work);
  else
    work.problem.free = work.reach.free;
}

// Pose, noise and open directions depend on each other.
OrDiagnosis<void> Settle(const TrackerLidarProblem& problem, TrackerLidarWork& work) {
  for (int round = 0; round < kRoundsMax; ++round) {
    FindReach(problem, work);
    if (auto solved = Solve(problem, work, kIterationsOnTheWay); !solved) return solved;
    if (!UpdateNoise(work)) break;
  }
  if (work.reach.free.cols() == 0) return tl::unexpected(NothingTold(problem));
  return Solve(problem, work, kStaticIterationsMax);
}

// Where most of a capture's boards are apart from where the others' say: the body, or a board, was elsewhere.
void Drop(TrackerLidarWork& work, std::size_t position, const std::string& why) {
  work.unused[work.captures[position]] = why;
  work.contradicting.push_back(work.captures[position]);
  EraseAt(position, work.captures, work.patches, work.problem.captures, work.state.T_world_body);
}

TrackerLidarCheck CheckOfPatch(const TrackerLidarWork& work, std::size_t position, std::size_t i) {
  const PlaneSighting& seen = work.problem.captures[position].seen[i];
  const Vector7d g = PlaneInLidar(work.problem.captures[position].T_world_body, work.state.T_body_lidar,
                                  work.state.planes[seen.plane_idx], work.problem.range_bias_m);
  const PlanePatch& patch = *work.patches[position][i].patch;
  return {seen.moments.sum.row(6).dot(g) / seen.moments.weight_per_m2, AngleBetween_rad(g.head<3>(), patch.normal),
          patch.points_m.size(), 1};
}

// Boards that stand elsewhere in some captures, or are something else there.
bool DropContradicting(TrackerLidarWork& work) {
  std::vector<double> distances_m, angles_rad;
  for (std::size_t k = 0; k < work.captures.size(); ++k)
    for (std::size_t i = 0; i < work.patches[k].size(); ++i) {
      const TrackerLidarCheck check = CheckOfPatch(work, k, i);
      distances_m.push_back(std::abs(check.distance_m));
      angles_rad.push_back(check.angle_rad);
    }
  const BoardGate gate(distances_m, angles_rad);
  bool any = false;
  std::size_t at = distances_m.size();
  for (std::size_t k = work.captures.size(); k-- > 0;) {
    for (std::size_t i = work.patches[k].size(); i-- > 0;) {
      --at;
      if (gate.Passes(distances_m[at], angles_rad[at])) continue;
      EraseAt(i, work.patches[k]);
      any = true;
    }
    if (work.patches[k].empty()) Drop(work, k, "its boards are not where the other captures have them");
  }
  return any;
}

// Boards that only one or two captures still show say nothing but their own plane.
void DropUnderobservedBoards(TrackerLidarWork& work) {
  std::vector<std::size_t> counts(work.state.planes.size(), 0), new_idx(work.state.planes.size(), 0);
  for (const auto& patches : work.patches)
    for (const ChosenPatch& chosen : patches) ++counts[chosen.board_idx];
  std::vector<WorldPlane> kept;
  for (std::size_t b = 0; b < counts.size(); ++b) {
    new_idx[b] = kept.size();
    if (counts[b] >= kTrackerLidarMin) kept.push_back(work.state.planes[b]);
  }
  for (std::size_t k = work.captures.size(); k-- > 0;) {
    std::erase_if(work.patches[k],
                  [&](const ChosenPatch& chosen) { return counts[chosen.board_idx] < kTrackerLidarMin; });
    for (ChosenPatch& chosen : work.patches[k]) chosen.board_idx = new_idx[chosen.board_idx];
    if (work.patches[k].empty()) Drop(work, k, "its boards are not where the other captures have them");
  }
  work.state.planes = std::move(kept);
}

}  // namespace

std::vector<const PlanePatch*> PatchesOf(const TrackerLidarCapture& capture) {
  std::vector<const PlanePatch*> patches;
  for (const CloudView& cloud : capture.clouds)
    for (const PlanePatch& patch : cloud.candidates) {
      const auto same = std::find_if(patches.begin(), patches.end(), [&](const PlanePatch* other) {
        return (other->centre_m - patch.centre_m).norm() < kSamePatch_m &&
               other->normal.dot(patch.normal) > kSamePatchCosine;
      });
      if (same == patches.end())
        patches.push_back(&patch);
      else if (patch.score > (*same)->score)
        *same = &patch;
    }
  return patches;
}

OrDiagnosis<TrackerLidarWork> CollectPatches(const TrackerLidarProblem& problem) {
  TrackerLidarWork work;
  std::vector<std::size_t> both;
  for (const std::size_t idx : ById(problem)) {
    const TrackerLidarCapture& capture = problem.captures[idx];
    std::string why = WhyUseless(problem, capture);
    for (const std::size_t other : both)
      if (why.empty() &&
          AreNear(*problem.captures[other].T_world_body, *capture.T_world_body, kSamePose_m, kSamePose_rad))
        why = "the body was where it was in " + problem.captures[other].capture.str();
    if (why.empty())
      both.push_back(idx);
    else
      work.unused[idx] = std::move(why);
  }
  if (both.size() < kTrackerLidarMin) return tl::unexpected(TooFewPlaced(problem, both.size()));
  const std::vector<Se3> poses = CentredPoses(problem, both);
  const std::size_t captures_min = std::max(kTrackerLidarMin, both.size() / kCapturesPerBoardPart);
  const auto consensus = FindStaticBoards(PlacedIn(problem, both, poses), problem.T_body_lidar_nominal, captures_min);
  if (!consensus || 2 * consensus->supporters < both.size())
    return tl::unexpected(NoStaticBoard(problem, both.size(), consensus ? consensus->supporters : 0));
  if (consensus->other && consensus->other_score >= kOtherRatio * consensus->score)
    return tl::unexpected(AmbiguousPlaces(problem));
  TakeConsensus(problem, *consensus, both, poses, work);
  SetProblem(problem, work);
  return work;
}

OrDiagnosis<void> FitPatches(const TrackerLidarProblem& problem, TrackerLidarWork& work) {
  const std::size_t begun = work.captures.size();
  for (int round = 0; round < kRejectionsMax; ++round) {
    DropUnderobservedBoards(work);
    if (work.captures.size() < kTrackerLidarMin || 2 * work.captures.size() < begun)
      return tl::unexpected(NoStaticBoard(problem, begun, work.captures.size()));
    FillMoments(work);
    if (auto settled = Settle(problem, work); !settled) return settled;
    if (round + 1 == kRejectionsMax || !DropContradicting(work)) break;
  }
  const MotionNoise noise{kTrackerSigma_m * std::sqrt(work.factor_translation),
                          kTrackerSigma_rad * std::sqrt(work.factor_rotation)};
  work.motion = ObservableByMotion(work.state.T_world_body, work.state.T_body_lidar, noise);
  return {};
}

StaticProblem ProblemWithBeamsMoved(const TrackerLidarWork& work, std::size_t group, double longer_m) {
  StaticProblem moved = work.problem;
  for (std::size_t k = 0; k < work.patches.size(); ++k)
    for (std::size_t i = 0; i < work.patches[k].size(); ++i)
      moved.captures[k].seen[i].moments =
          WeighedMoments(WithBeamsMoved(*work.patches[k][i].patch, group, longer_m), work.range_sigma_m);
  return moved;
}

TrackerLidarCheck CheckOf(const TrackerLidarWork& work, std::size_t position) {
  TrackerLidarCheck all;
  for (std::size_t i = 0; i < work.patches[position].size(); ++i) {
    const TrackerLidarCheck one = CheckOfPatch(work, position, i);
    all.distance_m += one.distance_m * one.distance_m;
    all.angle_rad += one.angle_rad * one.angle_rad;
    all.points += one.points;
    ++all.boards;
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, all.boards));
  all.distance_m = std::sqrt(all.distance_m / count);
  all.angle_rad = std::sqrt(all.angle_rad / count);
  return all;
}

}  // namespace rigcal::calib
