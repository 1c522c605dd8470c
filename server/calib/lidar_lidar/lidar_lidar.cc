#include "server/calib/lidar_lidar/lidar_lidar.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "server/calib/lidar_lidar/lidar_lidar_work.h"

namespace rigcal::calib {
namespace {

constexpr int kLockingsMax = 2;
constexpr double kAgreeingMin_ratio = 0.3;  // of the starts; fewer: the answer is a matter of luck
constexpr double kSamePose_rad = 0.03, kSamePoseVoxels = 0.25;
constexpr double kOtherPoseVoxels = 0.6, kOtherPose_rad = 0.06;
constexpr double kOtherScoreRatio = 0.985;  // of the best: another pose fits as well
constexpr double kAstrayScoreRatio = 0.5;   // of a right end: 0.41 was seen; where both are wrong 0.62 and more
// Far below what an answer needs, on the few captures of the starts. There the match differs from that of all captures
// by up to 0.15, and answers have 0.55 and more.
constexpr double kHopelessMatch_ratio = 0.25, kHopelessOverlap_ratio = 0.6 * kOverlapMin_ratio;

struct Solved {
  LidarLidarPose pose;
  std::vector<SurfacePairs> pairs;
  Directions unknown = Directions(6, 0);
};

std::vector<SurfacePairs> AllPairs(const LidarLidarWork& work, const Se3& T) {
  std::vector<SurfacePairs> pairs;
  for (const LidarClouds& clouds : work.clouds) pairs.push_back(PairsOf(clouds, T));
  return pairs;
}

std::size_t Count(const std::vector<SurfacePairs>& captures) {
  std::size_t count = 0;
  for (const SurfacePairs& capture : captures) count += capture.pairs.size();
  return count;
}

double MatchRatio(const std::vector<SurfacePairs>& captures) {
  std::size_t near = 0;
  for (const SurfacePairs& capture : captures) near += capture.near;
  return static_cast<double>(Count(captures)) / static_cast<double>(std::max<std::size_t>(near, 1));
}

// Along the unknown directions the pose stays where the nominal pose has it.
Se3 BackToNominal(const Se3& T, const Se3& nominal, const Directions& unknown) {
  const Vector6d off = (T.Inverse() * nominal).Log();
  return (T * Se3::Exp(unknown * (unknown.transpose() * off))).Normalized();
}

void Refit(const LidarLidarWork& work, const Se3& start, std::size_t first_level, Solved& solved) {
  solved.pose = FitFrom(work, start, first_level, solved.unknown);
  solved.pairs = AllPairs(work, solved.pose.T);
}

// What is unknown is found at a pose that may have slid along it: so once more, held at the nominal pose there, and
// again with the directions as they are then.
Solved SolveFrom(const LidarLidarWork& work, const Se3& start, std::size_t first_level) {
  Solved solved;
  Refit(work, start, first_level, solved);
  for (int round = 0; round < kLockingsMax; ++round) {
    solved.unknown = Unknown(solved.pairs, solved.pose.T);
    if (solved.unknown.cols() == 0 || solved.unknown.cols() == 6) return solved;
    Refit(work, BackToNominal(solved.pose.ndt, work.nominal, solved.unknown), first_level, solved);
  }
  return solved;
}

// Difference of two poses, apart from what is not known of either.
Vector6d Difference(const Se3& T, const Se3& other, const Directions& unknown) {
  const Vector6d d = (T.Inverse() * other).Log();
  return d - unknown * (unknown.transpose() * d);
}

double AgreeingRatio(const std::vector<StartEnd>& ends, const StartEnd& best, const Directions& unknown,
                     double voxel_m) {
  const auto same = std::count_if(ends.begin(), ends.end(), [&](const StartEnd& end) {
    const Vector6d d = Difference(best.T, end.T, unknown);
    return d.head<3>().norm() <= kSamePoseVoxels * voxel_m && d.tail<3>().norm() <= kSamePose_rad;
  });
  return static_cast<double>(same) / static_cast<double>(ends.size());
}

const StartEnd* OtherPose(const std::vector<StartEnd>& ends, const StartEnd& best, const Directions& unknown,
                          double voxel_m) {
  for (const StartEnd& end : ends) {
    const Vector6d d = Difference(best.T, end.T, unknown);
    const bool apart = d.head<3>().norm() > kOtherPoseVoxels * voxel_m || d.tail<3>().norm() > kOtherPose_rad;
    if (apart && end.score > kOtherScoreRatio * best.score) return &end;
  }
  return nullptr;
}

// Whether the answer may be believed.
OrDiagnosis<void> Judge(const LidarLidarProblem& problem, const LidarLidarWork& work, const Solved& solved,
                        const std::vector<StartEnd>& ends, const StartEnd& best) {
  const std::size_t pairs = Count(solved.pairs);
  if (!solved.pose.T.p_m.allFinite() || solved.pose.met_ratio < kOverlapMin_ratio || pairs < kPairsMin)
    return tl::unexpected(LowOverlap(problem, solved.pose.met_ratio, pairs));
  if (MatchRatio(solved.pairs) < kMatchMin_ratio) return tl::unexpected(PoorFit(problem, MatchRatio(solved.pairs)));
  if (solved.unknown.cols() == 6) return tl::unexpected(NoStructure(problem));
  if (!solved.pose.converged) return tl::unexpected(NotConverged(problem, solved.pose.last_step));
  if (const StartEnd* other = OtherPose(ends, best, solved.unknown, work.voxel_m)) {
    const Vector6d d = Difference(best.T, other->T, solved.unknown);
    return tl::unexpected(StartsDisagree(problem, d.head<3>().norm(), d.tail<3>().norm()));
  }
  if (const double agreeing = AgreeingRatio(ends, best, solved.unknown, work.voxel_m); agreeing < kAgreeingMin_ratio)
    return tl::unexpected(StartsScatter(problem, agreeing));
  return {};
}

// Spares the fit of all captures where it never settles, for there is nothing to settle at.
OrDiagnosis<void> JudgeStart(const LidarLidarProblem& problem, const LidarLidarWork& work, const StartEnd& best) {
  std::vector<SurfacePairs> few;
  for (const std::size_t i : StartCaptures(work)) few.push_back(PairsOf(work.clouds[i], best.T));
  const std::size_t pairs = Count(few);
  const double match_ratio = MatchRatio(few);
  if (best.met_ratio >= kHopelessOverlap_ratio && match_ratio >= kHopelessMatch_ratio) return {};
  if (best.met_ratio < kOverlapMin_ratio || pairs < kPairsMin)
    return tl::unexpected(LowOverlap(problem, best.met_ratio, pairs));
  return tl::unexpected(PoorFit(problem, match_ratio));
}

SurfaceCheck CheckOf(const std::vector<SurfacePairs>& blocks, const std::vector<Se3>& T) {
  SurfaceCheck check;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (const NormalPair& pair : blocks[i].normals) {
      const Eigen::Vector3d turned = T[i].R() * pair.normal_moving;
      check.D += pair.normal_map.dot(turned);
      check.angle_rad += std::atan2(pair.normal_map.cross(turned).norm(), pair.normal_map.dot(turned));
      ++check.normals;
    }
    for (const SurfacePair& pair : blocks[i].pairs) {
      sum -= pair.distance_m * pair.normal_map;
      squares += pair.distance_m * pair.distance_m;
      ++check.pairs;
    }
  }
  const auto normals = static_cast<double>(std::max<std::size_t>(check.normals, 1)),
             pairs = static_cast<double>(std::max<std::size_t>(check.pairs, 1));
  check.D /= normals;
  check.angle_rad /= normals;
  check.E_l_m = sum.norm() / pairs;
  check.rms_m = std::sqrt(squares / pairs);
  return check;
}

void FillChecks(const LidarLidarProblem& problem, const LidarLidarWork& work, const Se3& T,
                const LidarLidarBlocks& blocks, LidarLidarEstimate& estimate) {
  std::vector<Se3> poses;
  for (const Vector6d& d : blocks.d) poses.push_back(T * Se3::Exp(d));
  estimate.check = CheckOf(blocks.pairs, poses);
  estimate.check_on_captures = work.clouds.size() > 1;
  if (!estimate.check_on_captures) {
    const Vector6d apart = blocks.d[0] - blocks.d[1];
    estimate.halves_m = apart.head<3>().norm();
    estimate.halves_rad = apart.tail<3>().norm();
  }
  std::map<CaptureId, double> rms_m;
  for (std::size_t k = 0; k < work.used.size(); ++k)
    rms_m[problem.captures[work.used[k]].capture] =
        estimate.check_on_captures ? CheckOf({blocks.pairs[k]}, {poses[k]}).rms_m : estimate.check.rms_m;
  for (const LidarLidarCapture& capture : problem.captures) {
    const auto at = rms_m.find(capture.capture);
    if (at != rms_m.end())
      estimate.residuals.push_back({capture.capture, at->second, true, {}});
    else
      estimate.residuals.push_back(
          {capture.capture, 0.0, false,
           capture.why_not.empty() ? "one of its clouds has too few points" : capture.why_not});
  }
}

Directions InEdge(const LidarLidarWork& work, const Se3& T, const Directions& unknown) {
  return work.a_is_map ? unknown : Directions(Adjoint(T) * unknown);
}

void AddNotes(const LidarLidarProblem& problem, const LidarLidarWork& work, const Solved& solved,
              std::vector<Diagnosis>& notes) {
  if (solved.unknown.cols() > 0)
    notes.push_back(DirectionsUnknown(problem, InEdge(work, solved.pose.T, solved.unknown)));
  if (work.used.size() == 1) notes.push_back(SingleCapture(problem));
  if (work.used.size() > 1 && work.used.size() < kCloudsEnough) notes.push_back(FewClouds(problem, work.used.size()));
  if (!problem.lidar_a.range_bias_sigma_m || !problem.lidar_b.range_bias_sigma_m)
    notes.push_back(RangesTakenAsExact(problem));
  std::vector<CaptureId> left_out;
  for (const LidarLidarCapture& capture : problem.captures)
    if (!IsUsable(capture)) left_out.push_back(capture.capture);
  if (!left_out.empty()) notes.push_back(CloudsLeftOut(problem, left_out));
}

OrDiagnosis<LidarLidarEstimate> Finished(const LidarLidarProblem& problem, const LidarLidarWork& work,
                                         const Solved& solved) {
  const Se3& T = solved.pose.T;
  const LidarLidarBlocks blocks = LeaveBlocksOut(work, T, solved.unknown);
  LidarLidarEstimate estimate;
  estimate.T_a_b = work.a_is_map ? T : T.Inverse().Normalized();
  estimate.T_a_b_ndt = work.a_is_map ? solved.pose.ndt : solved.pose.ndt.Inverse().Normalized();
  estimate.T_a_b_polished = work.a_is_map ? solved.pose.polished : solved.pose.polished.Inverse().Normalized();
  estimate.polished = work.polish;
  estimate.voxel_m = work.voxel_m;
  estimate.last_step = solved.pose.last_step;
  estimate.overlap_ratio = solved.pose.met_ratio;
  estimate.match_ratio = MatchRatio(solved.pairs);
  FillChecks(problem, work, T, blocks, estimate);
  auto uncertainty = LidarLidarUncertainty(problem, work, solved.pose, solved.unknown, solved.pairs, blocks.d);
  if (!uncertainty) return tl::unexpected(LidarLidarError(problem, uncertainty.error()));
  estimate.uncertainty = std::move(*uncertainty);
  return estimate;
}

const StartEnd& BestOf(const std::vector<StartEnd>& ends) {
  return *std::max_element(ends.begin(), ends.end(),
                           [](const StartEnd& x, const StartEnd& y) { return x.score < y.score; });
}

struct Starts {
  std::vector<StartEnd> ends;
  std::size_t first_level = 0;
};

// Coarse maps of a room may lead all starts astray, even from the truth. Then the nominal pose ends far better on the
// finer ones alone, and these are asked from all starts.
Starts StartsOf(const LidarLidarWork& work) {
  Starts coarse{TryStarts(work, 0), 0};
  const StartEnd finer = EndFrom(work, work.nominal, 1);
  if (BestOf(coarse.ends).score > kAstrayScoreRatio * finer.score) return coarse;
  return {TryStarts(work, 1), 1};
}

// Coarse maps of rings on a floor may lead nearly all starts astray; then the finer ones are asked, if what they find
// fits as well.
void AskFinerMaps(const LidarLidarWork& work, const Solved& solved, std::vector<StartEnd>& ends) {
  const StartEnd& best = BestOf(ends);
  if (AgreeingRatio(ends, best, solved.unknown, work.voxel_m) >= kAgreeingMin_ratio) return;
  std::vector<StartEnd> finer = TryStarts(work, 1);
  if (BestOf(finer).score > kOtherScoreRatio * best.score) ends = std::move(finer);
}

}  // namespace

OrDiagnosis<LidarLidarEstimate> EstimateLidarLidar(const LidarLidarProblem& problem, std::vector<Diagnosis>* notes) {
  if (!problem.T_a_b_nominal) return tl::unexpected(NoNominalPose(problem));
  if (std::none_of(problem.captures.begin(), problem.captures.end(), IsUsable))
    return tl::unexpected(NoCommonClouds(problem));
  const LidarLidarWork work = WorkOf(problem);
  auto [ends, first_level] = StartsOf(work);
  if (auto judged = JudgeStart(problem, work, BestOf(ends)); !judged) return tl::unexpected(judged.error());
  const Solved solved = SolveFrom(work, BestOf(ends).T, first_level);
  AskFinerMaps(work, solved, ends);
  const StartEnd& best = BestOf(ends);
  if (auto judged = Judge(problem, work, solved, ends, best); !judged) return tl::unexpected(judged.error());
  auto estimate = Finished(problem, work, solved);
  if (!estimate) return estimate;
  estimate->agreeing_ratio = AgreeingRatio(ends, best, solved.unknown, work.voxel_m);
  if (notes != nullptr) AddNotes(problem, work, solved, *notes);
  return estimate;
}

}  // namespace rigcal::calib
