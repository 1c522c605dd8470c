#include "server/calib/lidar_camera/patch_choice.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "server/calib/core/robust.h"

namespace rigcal::calib {
namespace {

// How far a patch and a board may be apart and still be the same: few beams sample a plate coarsely, so its centre is
// rough.
constexpr double kAngleTolerance_rad = 0.2, kCentreTolerance_m = 0.3;
// Two captures that do not differ by this much say nothing about the rotation.
constexpr double kSmallestTurn_rad = 0.15, kSmallestShift_m = 0.4;
// Pairs grow with the square of the captures that propose, scores with the number of proposals.
constexpr std::size_t kProposersMax = 60, kHypothesesMax = 4000;
constexpr int kRefinementsMax = 5;
constexpr double kOtherAngle_rad = 0.3, kOtherShift_m = 0.5;
constexpr int kRivalTries = 20;
constexpr double kNominalAngle_rad = 0.785, kNominalShift_m = 1.0;
constexpr double kAlmostAsManyRatio = 0.8;

// Squared, in units of the tolerances.
double Disagreement(const BoardPlane& camera, const BoardPlane& lidar, const Se3& T_cam_lidar) {
  const double angle = AngleBetween_rad(camera.normal, T_cam_lidar.q * lidar.normal) / kAngleTolerance_rad;
  const double shift = (camera.centre_m - T_cam_lidar * lidar.centre_m).norm() / kCentreTolerance_m;
  return angle * angle + shift * shift;
}

struct Best {
  PlaneMatch match;
  double disagreement = 1.0;
};

Best BestOf(const PlaneCandidates& capture, const Se3& T_cam_lidar) {
  Best best;
  for (std::size_t c = 0; c < capture.camera.size(); ++c)
    for (std::size_t l = 0; l < capture.lidar.size(); ++l)
      if (const double now = Disagreement(capture.camera[c], capture.lidar[l], T_cam_lidar); now < best.disagreement)
        best = {{c, l}, now};
  return best;
}

// Sum over captures, at most 1 each: the fewer and the nearer, the better.
double ScoreOf(const std::vector<PlaneCandidates>& captures, const Se3& T_cam_lidar) {
  double score = 0;
  for (const PlaneCandidates& capture : captures) score += BestOf(capture, T_cam_lidar).disagreement;
  return score;
}

struct Correspondence {
  BoardPlane camera, lidar;
};

// Rotation from normals and centres about their means, then the shift. Empty where they leave the rotation open.
std::optional<Se3> Procrustes(const std::vector<Correspondence>& pairs) {
  Eigen::Vector3d mean_cam = Eigen::Vector3d::Zero(), mean_lidar = Eigen::Vector3d::Zero();
  for (const Correspondence& pair : pairs) mean_cam += pair.camera.centre_m, mean_lidar += pair.lidar.centre_m;
  mean_cam /= static_cast<double>(pairs.size());
  mean_lidar /= static_cast<double>(pairs.size());
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  const double normal_weight = 1 / (kAngleTolerance_rad * kAngleTolerance_rad);
  const double centre_weight = 1 / (kCentreTolerance_m * kCentreTolerance_m);
  for (const Correspondence& pair : pairs) {
    H += normal_weight * pair.camera.normal * pair.lidar.normal.transpose();
    H += centre_weight * (pair.camera.centre_m - mean_cam) * (pair.lidar.centre_m - mean_lidar).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > 1e-3 * svd.singularValues()[0])) return std::nullopt;
  Eigen::Matrix3d D = Eigen::Matrix3d::Identity();
  D(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  Se3 T_cam_lidar;
  T_cam_lidar.q = Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * D * svd.matrixV().transpose()));
  T_cam_lidar.p_m = mean_cam - T_cam_lidar.q * mean_lidar;
  return T_cam_lidar.Normalized();
}

// The two boards stand to each other as the two patches do, and in a way that tells the rotation.
bool Consistent(const Correspondence& i, const Correspondence& j) {
  const double turn_cam = AngleBetween_rad(i.camera.normal, j.camera.normal);
  const double turn_lidar = AngleBetween_rad(i.lidar.normal, j.lidar.normal);
  if (std::abs(turn_cam - turn_lidar) > kAngleTolerance_rad) return false;
  const double shift_cam = (i.camera.centre_m - j.camera.centre_m).norm();
  const double shift_lidar = (i.lidar.centre_m - j.lidar.centre_m).norm();
  if (std::abs(shift_cam - shift_lidar) > kCentreTolerance_m) return false;
  return turn_cam > kSmallestTurn_rad || shift_cam > kSmallestShift_m;
}

std::vector<std::pair<std::size_t, Correspondence>> SpreadCorrespondences(
    const std::vector<PlaneCandidates>& captures) {
  std::vector<std::pair<std::size_t, Correspondence>> all;
  const std::vector<PlaneCandidates> proposers = SpreadOver(captures, kProposersMax);
  for (std::size_t i = 0; i < proposers.size(); ++i) {
    for (const BoardPlane& camera : proposers[i].camera)
      for (const BoardPlane& lidar : proposers[i].lidar) all.push_back({i, {camera, lidar}});
  }
  return all;
}

std::vector<Se3> Hypotheses(const std::vector<PlaneCandidates>& captures) {
  const auto all = SpreadCorrespondences(captures);
  std::vector<Se3> hypotheses;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (all[i].first == all[j].first || !Consistent(all[i].second, all[j].second)) continue;
      if (const auto T = Procrustes({all[i].second, all[j].second})) hypotheses.push_back(*T);
    }
  return SpreadOver(hypotheses, kHypothesesMax);
}

PatchChoice ChoiceAt(const std::vector<PlaneCandidates>& captures, const Se3& T_cam_lidar) {
  PatchChoice choice;
  choice.T_cam_lidar = T_cam_lidar;
  for (const PlaneCandidates& capture : captures) choice.matches.push_back(BestMatch(capture, T_cam_lidar));
  choice.supporters = static_cast<std::size_t>(
      std::count_if(choice.matches.begin(), choice.matches.end(), [](const auto& match) { return match.has_value(); }));
  return choice;
}

// Procrustes over everything that agrees, until nothing changes.
PatchChoice Refined(const std::vector<PlaneCandidates>& captures, PatchChoice choice) {
  for (int round = 0; round < kRefinementsMax; ++round) {
    std::vector<Correspondence> pairs;
    for (std::size_t k = 0; k < captures.size(); ++k)
      if (choice.matches[k])
        pairs.push_back(
            {captures[k].camera[choice.matches[k]->camera_idx], captures[k].lidar[choice.matches[k]->lidar_idx]});
    const auto T = pairs.empty() ? std::nullopt : Procrustes(pairs);
    if (!T) break;
    const PatchChoice next = ChoiceAt(captures, *T);
    if (ScoreOf(captures, *T) >= ScoreOf(captures, choice.T_cam_lidar)) break;
    choice = next;
  }
  return choice;
}

bool IsAnother(const Se3& T, const Se3& S) {
  const Se3 difference = T.Inverse() * S;
  return difference.Log().tail<3>().norm() > kOtherAngle_rad || difference.p_m.norm() > kOtherShift_m;
}

double DistanceFrom(const Se3& nominal, const Se3& T) {
  const Se3 difference = nominal.Inverse() * T;
  return difference.Log().tail<3>().norm() / kOtherAngle_rad + difference.p_m.norm() / kOtherShift_m;
}

bool Settles(const Se3& nominal, const Se3& taken, const Se3& other) {
  const Se3 difference = nominal.Inverse() * taken;
  if (difference.Log().tail<3>().norm() > kNominalAngle_rad || difference.p_m.norm() > kNominalShift_m) return false;
  return DistanceFrom(nominal, other) > 2 * DistanceFrom(nominal, taken);
}

// The best pose that stays another one when it is refined: many that begin elsewhere slide back.
std::optional<PatchChoice> RivalOf(const PatchChoice& choice, const std::vector<PlaneCandidates>& captures,
                                   const std::vector<Se3>& hypotheses,
                                   const std::vector<std::pair<double, std::size_t>>& ranked) {
  int tries = 0;
  for (const auto& [score, idx] : ranked) {
    if (!IsAnother(hypotheses[idx], choice.T_cam_lidar)) continue;
    PatchChoice rival = Refined(captures, ChoiceAt(captures, hypotheses[idx]));
    if (IsAnother(rival.T_cam_lidar, choice.T_cam_lidar)) return rival;
    if (++tries == kRivalTries) break;
  }
  return std::nullopt;
}

}  // namespace

std::optional<PlaneMatch> BestMatch(const PlaneCandidates& capture, const Se3& T_cam_lidar) {
  const Best best = BestOf(capture, T_cam_lidar);
  return best.disagreement < 1 ? std::optional(best.match) : std::nullopt;
}

std::optional<PatchChoice> ChoosePatches(const std::vector<PlaneCandidates>& captures,
                                         const std::optional<Se3>& nominal) {
  std::vector<Se3> hypotheses = Hypotheses(captures);
  if (nominal) hypotheses.push_back(*nominal);
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) ranked.emplace_back(ScoreOf(captures, hypotheses[i]), i);
  std::sort(ranked.begin(), ranked.end());
  if (ranked.empty()) return std::nullopt;
  PatchChoice choice = Refined(captures, ChoiceAt(captures, hypotheses[ranked.front().second]));
  if (choice.supporters < 2) return std::nullopt;
  std::optional<PatchChoice> rival = RivalOf(choice, captures, hypotheses, ranked);
  if (!rival) return choice;
  PatchChoice second = std::move(*rival);
  const bool almost =
      static_cast<double>(second.supporters) >= kAlmostAsManyRatio * static_cast<double>(choice.supporters);
  if (nominal && almost && DistanceFrom(*nominal, second.T_cam_lidar) < DistanceFrom(*nominal, choice.T_cam_lidar))
    std::swap(choice, second);
  choice.settled_by_nominal = nominal && Settles(*nominal, choice.T_cam_lidar, second.T_cam_lidar);
  choice.other = second.T_cam_lidar;
  choice.other_supporters = second.supporters;
  return choice;
}

}  // namespace rigcal::calib
