#include "server/calib/stereo/observability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/camera/lens_choice.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/core/joint_covariance.h"
#include "server/calib/core/selection.h"
#include "server/calib/planes/planar_pose.h"

namespace rigcal::calib {
namespace {

using View = std::optional<BoardView>;

// Well-tilted boards give 0.1 to 0.5 %; boards parallel to the picture give tens of per cent and more.
constexpr double kFocalSigmaMaxRatio = 0.03;
// Sigma of a coefficient times its power of the outermost radius, over what it is a part of: up to 20 where boards fill
// the picture (the rational model's halves nearly cancel), hundreds to thousands where they stay in its middle.
constexpr double kDistortionSigmaMax = 50.0;
// alpha has a range of 1, xi of 2, beta is above 0 (sigma over beta): of a wide lens they are known to some
// thousandths.
constexpr double kSphereSigmaMax = 0.3;

double LargestAngle_deg(const std::vector<Se3>& boards) {
  double smallest_cosine = 1;
  for (const Se3& left : boards)
    for (const Se3& right : boards) smallest_cosine = std::min(smallest_cosine, left.R().col(2).dot(right.R().col(2)));
  return std::acos(std::clamp(smallest_cosine, -1.0, 1.0)) * 180 / M_PI;
}

std::vector<Diagnosis> CheckSizes(const StereoProblem& problem) {
  std::vector<Diagnosis> diagnoses;
  const auto decoded = [](const BoardView& view) { return view.image_width_px != 0; };
  for (const auto camera : {&StereoCapture::a, &StereoCapture::b})
    if (const auto resized = Resized(CameraOf(problem, camera), decoded); !resized.empty())
      diagnoses.push_back(ImageSizeChanged(SensorOf(problem, camera).id, resized));
  return diagnoses;
}

std::vector<Diagnosis> ExplainTooFew(const StereoProblem& problem, const Selection& selection, std::size_t both) {
  const auto sees = [&](View StereoCapture::*camera) {
    return std::any_of(problem.captures.begin(), problem.captures.end(),
                       [&](const StereoCapture& capture) { return Sees(capture.*camera, problem.board); });
  };
  std::vector<Diagnosis> diagnoses;
  if (both == 0 && sees(&StereoCapture::a) && sees(&StereoCapture::b))
    diagnoses.push_back(NoCommonView(problem));
  else
    diagnoses.push_back(TooFewCaptures(problem, both));
  if (!selection.repeated.empty()) diagnoses.insert(diagnoses.begin(), IdenticalCaptures(problem, selection.repeated));
  return diagnoses;
}

void CheckTilt(const StereoProblem& problem, const std::vector<std::size_t>& used, std::vector<Diagnosis>& diagnoses) {
  for (const auto& [camera, side] : {std::pair{&StereoCapture::a, "_a"}, {&StereoCapture::b, "_b"}}) {
    const Sensor& sensor = SensorOf(problem, camera);
    if (sensor.intrinsics) continue;
    if (auto no_tilt = WhyNoTilt(sensor.id, ViewsOf(problem, used, camera)))
      diagnoses.push_back(OfSide(TiltOrLens(CameraOf(problem, camera), std::move(*no_tilt)), side));
  }
}

// Of the radius or angle, by which the coefficient's effect grows against the undistorted lens.
int PowerOf(CameraModel model, const std::string& name) {
  if (name[0] == 'p') return 1;
  const int order = name[1] - '0';
  return 2 * (model == CameraModel::kPinholeRational && order > 3 ? order - 3 : order);
}

// At s, the square of that radius: the numerator or the denominator that the coefficient is a part of. Both are large
// where a lens is wide, up to about (1 + s)^3; beyond that they only cancel.
double WholeAt(CameraModel model, const IntrinsicsVector& intrinsics, const std::string& name, double s) {
  if (model != CameraModel::kPinholeRational || name[0] == 'p') return 1.0;
  const Eigen::Vector3d powers(s, s * s, s * s * s), above(intrinsics[4], intrinsics[5], intrinsics[8]);
  const Eigen::Vector3d below = intrinsics.segment<3>(9);
  return std::clamp(1 + (name[1] > '3' ? below : above).dot(powers), 1.0, std::pow(1 + s, 3));
}

// Without distortion the two halves of the rational model are one: its focal length is judged as that of radtan. That
// of a sphere model is judged as a fisheye's, for which it is one of its few numbers, not nearly a sum of them.
CameraModel OutlookModel(CameraModel model) {
  if (IsSphere(model)) return CameraModel::kFisheyeKb4;
  return model == CameraModel::kPinholeRational ? CameraModel::kPinholeRadtan : model;
}

struct FocalOutlook {
  double sigma_ratio = 0;  // predicted sigma of the focal length over the focal length; infinite: not observable
  double spread_deg = 0;   // largest angle between the normals of two boards
};

FocalOutlook PredictFocal(CameraViews views) {
  const CameraModel model = views.model = OutlookModel(views.model);
  JointProblem joint = OneCamera({views.width_px, views.height_px, views.corners_board, {}, model}, true);
  JointState state;
  state.intrinsics_a = RoughIntrinsics(views);
  for (const SeenCorners& seen : views.seen) {
    const std::vector<Se3> poses = PlanarPoses(model, state.intrinsics_a, views.corners_board, seen);
    if (poses.empty()) continue;
    joint.captures.push_back({seen, {}});
    state.T_a_board.push_back(poses.front());
  }
  FocalOutlook outlook{std::numeric_limits<double>::infinity(), LargestAngle_deg(state.T_a_board)};
  if (joint.captures.empty()) return outlook;
  const auto normal = ReducedNormal(joint, state);
  if (!normal) return outlook;
  if (const auto inverse = InverseOfFree(*normal)) {
    const double sigma_px = kTypicalCornerSigma_px * std::sqrt((*inverse)(kIntrinsicsAStart, kIntrinsicsAStart));
    outlook.sigma_ratio = sigma_px / state.intrinsics_a[0];
  }
  return outlook;
}

std::optional<Diagnosis> WhySphereOpen(const SensorId& camera, CameraModel model, const Eigen::VectorXd& variances,
                                       const IntrinsicsVector& intrinsics) {
  const std::vector<std::string>& names = DistortionNames(model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = 4 + static_cast<Eigen::Index>(i);
    const double range = names[i] == "beta" ? intrinsics[at] : 1.0;
    if (!(std::sqrt(variances[at]) < kSphereSigmaMax * range)) return DistortionOpen(camera, model, names[i]);
  }
  return std::nullopt;
}

}  // namespace

std::optional<Diagnosis> WhyNoTilt(const SensorId& camera, const CameraViews& views) {
  const FocalOutlook outlook = PredictFocal(views);
  if (outlook.sigma_ratio < kFocalSigmaMaxRatio) return std::nullopt;
  return NoTilt(camera, outlook.spread_deg, outlook.sigma_ratio);
}

std::optional<Diagnosis> WhyDistortionOpen(const SensorId& camera, CameraModel model, const Eigen::VectorXd& variances,
                                           const CameraViews& views, const IntrinsicsVector& intrinsics) {
  if (model == CameraModel::kPinholeRadtan) return std::nullopt;
  if (IsSphere(model)) return WhySphereOpen(camera, model, variances, intrinsics);
  const double reach = SeenReach(model, intrinsics, views);
  const std::vector<std::string>& names = DistortionNames(model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double sigma = std::sqrt(variances[4 + static_cast<Eigen::Index>(i)]);
    const double effect =
        sigma * std::pow(reach, PowerOf(model, names[i])) / WholeAt(model, intrinsics, names[i], reach * reach);
    if (!(effect < kDistortionSigmaMax)) return DistortionOpen(camera, model, names[i]);
  }
  return std::nullopt;
}

std::vector<Diagnosis> Observability(const StereoProblem& problem) {
  std::vector<Diagnosis> diagnoses = CheckSizes(problem);
  if (!diagnoses.empty()) return diagnoses;
  const Selection selection = Select(problem);
  const std::size_t both = CountBoth(problem, selection.used);
  if (both < kCapturesMin) return ExplainTooFew(problem, selection, both);
  CheckTilt(problem, selection.used, diagnoses);
  return diagnoses;
}

}  // namespace rigcal::calib
