#include "server/calib/camera/camera_start.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "server/calib/core/robust.h"
#include "server/calib/planes/planar_pose.h"

namespace rigcal::calib {
namespace {

constexpr double kUsualXi = -0.2;       // of fisheyes; from 0 another minimum, nearly as deep, may be the nearer one
constexpr double kStereographic = 0.5;  // alpha, up to which a sphere model sees every pixel

}  // namespace

CameraViews Spread(const CameraViews& views, std::size_t count_max) {
  CameraViews spread = views;
  spread.seen = SpreadOver(views.seen, count_max);
  return spread;
}

JointProblem OneCamera(const CameraViews& views, bool estimate) {
  JointProblem joint;
  joint.corners_board = views.corners_board;
  joint.a.model = views.model;
  joint.a.estimate = estimate;
  joint.b.estimate = false;
  for (const SeenCorners& seen : views.seen) joint.captures.push_back({seen, {}});
  return joint;
}

double SeenReach(CameraModel model, const IntrinsicsVector& intrinsics, const CameraViews& views) {
  double reach = 0;
  for (const SeenCorners& seen : views.seen)
    for (const Eigen::Vector2d& uv_px : seen.uv_px) {
      const auto ray = Unproject(model, intrinsics, uv_px);
      if (!ray) continue;
      const double r = ray->head<2>().norm();
      reach = std::max(reach, IsPinhole(model) ? r / ray->z() : std::atan2(r, ray->z()));
    }
  return reach;
}

IntrinsicsVector PlainLens(CameraModel model, double focal_px, int width_px, int height_px) {
  IntrinsicsVector lens = IntrinsicsVector::Zero();
  lens.head<4>() << focal_px, focal_px, 0.5 * (width_px - 1), 0.5 * (height_px - 1);
  if (model == CameraModel::kEucm) lens.segment<2>(4) << kStereographic, 1.0;
  if (model == CameraModel::kDoubleSphere) {
    lens.segment<2>(4) << kUsualXi, kStereographic;
    lens.head<2>() *= 1 + kUsualXi;
  }
  return lens;
}

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
  if (!IsPinhole(views.model)) return intrinsics.allFinite();
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
  const IntrinsicsVector plain = PlainLens(views.model, intrinsics[0], views.width_px, views.height_px);
  for (int halving = 0; halving < kHalvingsMax && !SeesAll(views, intrinsics); ++halving) {
    const double part = halving + 1 < kHalvingsMax ? 0.5 : 0.0;
    intrinsics.tail<kIntrinsicsMax - 4>() *= part;
    intrinsics.tail<kIntrinsicsMax - 4>() += (1 - part) * plain.tail<kIntrinsicsMax - 4>();
  }
  return intrinsics;
}

struct PlacedBoards {
  JointProblem joint;  // with the intrinsics to be estimated
  JointState state;
  double cost_px2 = 0;
};

// The poses of all boards, refined with the intrinsics held. A view that no pose explains leaves the problem.
PlacedBoards PlaceBoards(const CameraViews& views, const IntrinsicsVector& intrinsics) {
  const JointProblem all = OneCamera(views, true);
  PlacedBoards placed{all, {}, 0};
  placed.joint.captures.clear();
  JointState state;
  state.intrinsics_a = placed.state.intrinsics_a = intrinsics;
  state.T_a_board.resize(all.captures.size());
  // No view counts more than one that is off by a tenth of the picture.
  const double worst_px = 0.1 * std::max(views.width_px, views.height_px);
  for (std::size_t k = 0; k < all.captures.size(); ++k) {
    const PoseChoice choice = ChoosePose(all, state, k, AllowedPoses(all, state, k));
    const double limit_px2 = worst_px * worst_px * static_cast<double>(all.captures[k].a.size());
    placed.cost_px2 += std::min(choice.ssr_px2, limit_px2);
    if (!(choice.ssr_px2 < limit_px2)) continue;
    placed.joint.captures.push_back(all.captures[k]);
    placed.state.T_a_board.push_back(choice.T_a_board);
  }
  return placed;
}

// Of the longer side.
constexpr std::array<double, 9> kFields_deg = {50, 65, 85, 105, 125, 150, 175, 200, 230};
constexpr std::size_t kViewsTried = 12;

// Half of the longer side is f times half of the field of view, or, stereographic, 2 f times the tangent of a quarter.
IntrinsicsVector PlainOfField(const CameraViews& views, double field_deg) {
  const double field_rad = field_deg * M_PI / 180;
  const double in_focals = IsSphere(views.model) ? 4 * std::tan(0.25 * field_rad) : field_rad;
  const double focal_px = std::max(views.width_px, views.height_px) / in_focals;
  return PlainLens(views.model, focal_px, views.width_px, views.height_px);
}

// The plain lens whose board poses reproject best.
IntrinsicsVector RoughWide(const CameraViews& views) {
  const CameraViews tried = Spread(views, kViewsTried);
  std::array<double, kFields_deg.size()> costs_px2{};
  for (std::size_t i = 0; i < kFields_deg.size(); ++i)
    costs_px2[i] = PlaceBoards(tried, PlainOfField(tried, kFields_deg[i])).cost_px2;
  const auto best = std::min_element(costs_px2.begin(), costs_px2.end()) - costs_px2.begin();
  return PlainOfField(views, kFields_deg[static_cast<std::size_t>(best)]);
}

}  // namespace

IntrinsicsVector RoughIntrinsics(const CameraViews& views) {
  if (!IsPinhole(views.model)) return RoughWide(views);
  const double side_px = std::max(views.width_px, views.height_px);
  IntrinsicsVector rough = PlainLens(views.model, side_px, views.width_px, views.height_px);
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

constexpr double kReachMax_rad = 80 * M_PI / 180;
constexpr int kSamples = 100;
constexpr int kTerms = 6;  // k1 k2 k3, then k4 k5 k6
// Of the equations' mean diagonal: the two halves nearly cancel, and of all that bend alike the smallest will do.
constexpr double kDamping = 1e-9;
constexpr double kOffMax_ratio = 0.01;  // of the focal length: a start may be off by so much

// Where the fisheye has a ray, in focal lengths from the principal point.
double Bent(const IntrinsicsVector& fisheye, double angle_rad) {
  const double s = angle_rad * angle_rad;
  return angle_rad * (1 + s * (fisheye[4] + s * (fisheye[5] + s * (fisheye[6] + s * fisheye[7]))));
}

struct Equations {
  Eigen::Matrix<double, kSamples, kTerms> by_terms;
  Eigen::Matrix<double, kSamples, 1> wanted;
};

// q (1 + k4 s + k5 s^2 + k6 s^3) = 1 + k1 s + k2 s^2 + k3 s^3 with q the fisheye's radius over the undistorted one,
// times the latter, at angles up to the reach; s in units of its largest value.
Equations EquationsOf(const IntrinsicsVector& fisheye, double reach_rad) {
  Equations equations;
  for (int i = 0; i < kSamples; ++i) {
    const double angle_rad = reach_rad * (i + 1) / kSamples, r = std::tan(angle_rad);
    const double quotient = Bent(fisheye, angle_rad) / r, s = std::pow(r / std::tan(reach_rad), 2);
    const Eigen::RowVector3d powers(s, s * s, s * s * s);
    equations.by_terms.row(i) << r * powers, -r * quotient * powers;
    equations.wanted[i] = r * (quotient - 1);
  }
  return equations;
}

// The rational lens that bends as the fisheye does up to `reach_rad` from the axis, focal lengths and principal point
// as they are. Nothing where a pinhole does not see as far, or no quotient bends so.
std::optional<IntrinsicsVector> RationalLike(const IntrinsicsVector& fisheye, double reach_rad) {
  if (!(reach_rad > 0 && reach_rad < kReachMax_rad)) return std::nullopt;
  const Equations equations = EquationsOf(fisheye, reach_rad);
  Eigen::Matrix<double, kTerms, kTerms> normal = equations.by_terms.transpose() * equations.by_terms;
  normal.diagonal().array() += kDamping * normal.trace() / kTerms;
  const Eigen::Matrix<double, kTerms, 1> k = normal.ldlt().solve(equations.by_terms.transpose() * equations.wanted);
  const double s = std::pow(std::tan(reach_rad), 2);
  IntrinsicsVector rational = IntrinsicsVector::Zero();
  rational.head<4>() = fisheye.head<4>();
  rational.tail<8>() << k[0] / s, k[1] / (s * s), 0, 0, k[2] / (s * s * s), k[3] / s, k[4] / (s * s),
      k[5] / (s * s * s);
  for (const double part : {0.25, 0.5, 0.75, 1.0}) {
    const double angle_rad = part * reach_rad;
    const Projection at =
        Project(CameraModel::kPinholeRational, rational, {std::sin(angle_rad), 0, std::cos(angle_rad)});
    const double off_px = at.uv_px.x() - rational[2] - rational[0] * Bent(fisheye, angle_rad);
    if (!at.in_front || !(std::abs(off_px) < kOffMax_ratio * rational[0])) return std::nullopt;
  }
  return rational;
}

Result<IntrinsicsVector> StartAs(CameraModel model, CameraViews spread) {
  spread.model = model;
  PlacedBoards placed = PlaceBoards(spread, RoughIntrinsics(spread));
  if (model == CameraModel::kPinholeRadtan) placed.joint.a.held = kTangentialAndThird;
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
