#include "server/calib/camera/camera_start.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "server/calib/camera/fisheye_start.h"
#include "server/calib/camera/rational_start.h"
#include "server/calib/camera/seen_reach.h"
#include "server/calib/planes/placed_boards.h"

namespace rigcal::calib {
namespace {

// Enough for a start, and the cost of OpenCV's solver grows with the cube of the number of views.
constexpr std::size_t kViewsMax = 30;
// Lenses from 10 to 150 degrees of view; a start outside comes from noise.
constexpr int kHalvingsMax = 6;
// Of a radtan lens p1, p2 and k3, as in Zhang (2000): a few noisy views would give them any value.
const std::vector<int> kTangentialAndThird = {6, 7, 8};
constexpr double kFocalMinRatio = 0.15, kFocalMaxRatio = 6.0;

struct CvViews {
  std::vector<std::vector<cv::Point3f>> object;
  std::vector<std::vector<cv::Point2f>> image;
};

CvViews CvViewsOf(const CameraViews& views) {
  CvViews result;
  for (const SeenCorners& seen : views.seen) {
    std::vector<cv::Point3f> object;
    std::vector<cv::Point2f> image;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Eigen::Vector3f p = views.corners_board[static_cast<std::size_t>(seen.idx[i])].cast<float>();
      const Eigen::Vector2f uv = seen.uv_px[i].cast<float>();
      object.emplace_back(p.x(), p.y(), p.z());
      image.emplace_back(uv.x(), uv.y());
    }
    result.object.push_back(std::move(object));
    result.image.push_back(std::move(image));
  }
  return result;
}

bool Plausible(double focal_px, const CameraViews& views) {
  const double side_px = std::max(views.width_px, views.height_px);
  return std::isfinite(focal_px) && focal_px > kFocalMinRatio * side_px && focal_px < kFocalMaxRatio * side_px;
}

bool CanBe(const IntrinsicsVector& intrinsics, const CameraViews& views) {
  if (views.model == CameraModel::kFisheyeKb4) return intrinsics.allFinite();
  return intrinsics.allFinite() && Plausible(intrinsics[0], views) && Plausible(intrinsics[1], views);
}

tl::unexpected<Error> NoIntrinsics() {
  return Fail(ErrorCode::kInvalidInput, "its intrinsics cannot be found from these views",
              "Take more captures with the board tilted in different directions.");
}

bool SeesAll(const CameraViews& views, const IntrinsicsVector& intrinsics) {
  for (const SeenCorners& seen : views.seen)
    for (const Eigen::Vector2d& uv_px : seen.uv_px)
      if (!Unproject(views.model, intrinsics, uv_px)) return false;
  return true;
}

// Noise may give a distortion that folds over inside the picture: less of it will do for a start.
IntrinsicsVector WithoutFold(const CameraViews& views, IntrinsicsVector intrinsics) {
  for (int halving = 0; halving < kHalvingsMax && !SeesAll(views, intrinsics); ++halving)
    intrinsics.tail<kIntrinsicsMax - 4>() *= halving + 1 < kHalvingsMax ? 0.5 : 0.0;
  return intrinsics;
}

}  // namespace

CameraViews Spread(const CameraViews& views, std::size_t count_max) {
  CameraViews spread = views;
  const std::size_t total = views.seen.size(), count = std::min(total, count_max);
  spread.seen.clear();
  for (std::size_t i = 0; i < count; ++i) spread.seen.push_back(views.seen[i * total / count]);
  return spread;
}

JointProblem OneCamera(const CameraViews& views, bool estimate) {
  JointProblem joint;
  joint.corners_board = views.corners_board;
  joint.model_a = views.model;
  joint.estimate_a = estimate;
  joint.estimate_b = false;
  for (const SeenCorners& seen : views.seen) joint.captures.push_back({seen, {}});
  return joint;
}

IntrinsicsVector RoughIntrinsics(const CameraViews& views) {
  if (views.model == CameraModel::kFisheyeKb4) return RoughFisheye(views);
  const double side_px = std::max(views.width_px, views.height_px);
  IntrinsicsVector rough = IntrinsicsVector::Zero();
  rough.head<4>() << side_px, side_px, 0.5 * (views.width_px - 1), 0.5 * (views.height_px - 1);
  try {
    const CvViews cv_views = CvViewsOf(Spread(views, kViewsMax));
    const cv::Mat matrix =
        cv::initCameraMatrix2D(cv_views.object, cv_views.image, {views.width_px, views.height_px}, 1.0);
    const double focal_px = matrix.at<double>(0, 0);
    if (Plausible(focal_px, views)) rough.head<2>().setConstant(focal_px);
  } catch (const cv::Exception& exception) {
    if (exception.code == cv::Error::StsNoMem) throw;
    // The fallback stands.
  }
  return rough;
}

namespace {

Result<IntrinsicsVector> StartAs(CameraModel model, CameraViews spread) {
  spread.model = model;
  PlacedBoards placed = PlaceBoards(spread, RoughIntrinsics(spread));
  if (model == CameraModel::kPinholeRadtan) placed.joint.held_a = kTangentialAndThird;
  const auto refined = SolveJoint(placed.joint, placed.state);
  if (!refined || !CanBe(refined->state.intrinsics_a, spread)) return NoIntrinsics();
  return refined->state.intrinsics_a;
}

// Of a lens too wide for a series of radii: what a fisheye makes of the views, as a quotient.
std::optional<IntrinsicsVector> WideRationalStart(const CameraViews& spread) {
  const auto fisheye = StartAs(CameraModel::kFisheyeKb4, spread);
  if (!fisheye) return std::nullopt;
  const auto rational = RationalLike(*fisheye, SeenReach(CameraModel::kFisheyeKb4, *fisheye, spread));
  return rational && CanBe(*rational, spread) ? rational : std::nullopt;
}

// Without its denominator, or from a fisheye: whose boards reproject better.
Result<IntrinsicsVector> RationalStart(const CameraViews& views, const CameraViews& spread) {
  auto start = StartAs(CameraModel::kPinholeRadtan, spread);
  if (start) start = WithoutFold(views, *start);
  const auto wide = WideRationalStart(spread);
  if (!wide || !SeesAll(views, *wide)) return start;
  if (start && PlaceBoards(spread, *start).cost_px2 <= PlaceBoards(spread, *wide).cost_px2) return start;
  return *wide;
}

}  // namespace

Result<IntrinsicsVector> StartIntrinsics(const CameraViews& views) {
  const CameraViews spread = Spread(views, kViewsMax);
  if (views.model == CameraModel::kPinholeRational) return RationalStart(views, spread);
  RIGCAL_ASSIGN(const IntrinsicsVector start, StartAs(views.model, spread));
  return WithoutFold(views, start);
}

}  // namespace rigcal::calib
