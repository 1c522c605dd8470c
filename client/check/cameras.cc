#include "client/check/cameras.h"

#include <algorithm>
#include <cmath>

#include "client/check/edge_width.h"
#include "server/base/process/out_of_memory.h"
#include "server/calib/camera/camera_fit.h"
#include "server/calib/camera/camera_start.h"
#include "server/calib/core/selection.h"
#include "server/calib/planes/planar_pose.h"

namespace rigcal::check {
namespace {

using Pictures = std::map<CaptureId, PictureSeen>;

const TargetSeen* SeenOf(const PictureSeen& picture, const TargetId& target) {
  const auto seen = picture.seen.find(target);
  return seen == picture.seen.end() ? nullptr : &seen->second;
}

std::size_t FoundIn(const Pictures& pictures, const TargetId& target) {
  return static_cast<std::size_t>(std::count_if(pictures.begin(), pictures.end(), [&](const auto& picture) {
    const TargetSeen* seen = SeenOf(picture.second, target);
    return seen != nullptr && seen->view.found;
  }));
}

void SetSizes(const Pictures& pictures, CameraFound& found) {
  std::map<std::pair<int, int>, std::size_t> sizes;
  for (const auto& [capture, picture] : pictures)
    if (picture.width_px > 0) ++sizes[{picture.width_px, picture.height_px}];
  if (sizes.empty()) return;
  const auto usual =
      std::max_element(sizes.begin(), sizes.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
  found.width_px = usual->first.first, found.height_px = usual->first.second;
  for (const auto& [capture, picture] : pictures)
    if (picture.width_px > 0 && (picture.width_px != found.width_px || picture.height_px != found.height_px))
      found.resized.push_back(capture);
}

void SetFound(const Pictures& pictures, CameraFound& found) {
  for (const auto& [capture, picture] : pictures) {
    const TargetSeen* seen = SeenOf(picture, found.board->id);
    if (seen == nullptr) continue;
    if (seen->view.found) {
      found.with_board.push_back(capture);
      found.corners += seen->view.corners_px.size();
    } else if (picture.width_px > 0) {
      if (found.without_board.empty()) found.why_not = seen->view.why_not;
      found.without_board.push_back(capture);
    }
  }
}

void SetSharpness(const Pictures& pictures, CameraFound& found) {
  std::vector<BlurredPicture> edges;
  for (const auto& [capture, picture] : pictures)
    if (const TargetSeen* seen = SeenOf(picture, found.board->id); seen != nullptr && seen->edge_px)
      edges.push_back({capture, *seen->edge_px});
  if (edges.empty()) return;
  std::vector<double> widths_px;
  for (const BlurredPicture& edge : edges) widths_px.push_back(edge.edge_px);
  const auto middle = widths_px.begin() + static_cast<std::ptrdiff_t>(widths_px.size() / 2);
  std::nth_element(widths_px.begin(), middle, widths_px.end());
  found.edge_px = *middle;
  for (const BlurredPicture& edge : edges)
    if (edge.edge_px >= BlurredFrom_px(found.width_px, *found.edge_px)) found.blurred.push_back(edge);
}

CameraFit Rough(const calib::CameraProblem& problem) {
  const calib::CameraViews views = calib::ViewsOf(problem);
  if (views.seen.empty()) return calib::SeenBy(problem);
  const calib::IntrinsicsVector intrinsics =
      problem.camera.intrinsics ? calib::VectorOf(*problem.camera.intrinsics) : calib::RoughIntrinsics(views);
  std::map<CaptureId, Se3> T_cam_board;
  for (const auto& [capture, view] : problem.views) {
    if (!calib::WhyUnusable(view, problem.board).empty()) continue;
    const auto poses =
        calib::PlanarPoses(views.model, intrinsics, views.corners_board, calib::SeenIn(view, problem.board));
    if (!poses.empty()) T_cam_board[capture] = poses.front();
  }
  return calib::FitOf(problem, calib::IntrinsicsOf(views.model, intrinsics), T_cam_board);
}

// Without refinement; where a library gives up, without poses.
CameraFit RoughFit(const calib::CameraProblem& problem) {
  try {
    return Rough(problem);
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw;
    return calib::SeenBy(problem);
  }
}

void SetStands(const CameraFit& fit, CameraFound& found) {
  found.ring = RingOf(fit);
  found.distances = DistancesOf(fit, *found.board);
}

// Of the focal length on the axis, which of a double sphere is fx / (1 + xi): the two by themselves are known far
// worse.
double FocalSigma_ratio(const CameraFit& fit) {
  const double fx_sigma_ratio = fit.sigma.front() / fit.intrinsics.fx_px;
  if (fit.intrinsics.model != CameraModel::kDoubleSphere || fit.covariance.size() == 0) return fx_sigma_ratio;
  constexpr Eigen::Index kXi = 4;
  Eigen::VectorXd by = Eigen::VectorXd::Zero(fit.covariance.rows());
  by[0] = 1 / fit.intrinsics.fx_px, by[kXi] = -1 / (1 + fit.intrinsics.distortion.front());
  return std::sqrt(by.dot(fit.covariance * by));
}

void SetLens(const calib::CameraProblem& problem, calib::CameraMemory& lenses, CameraFound& found) {
  const auto estimate = lenses.Estimate(problem);
  if (!estimate) {
    found.lens_problem = estimate.error();
    return SetStands(RoughFit(problem), found);
  }
  const CameraFit fit = calib::FitOf(problem, estimate->intrinsics, estimate->T_cam_board);
  SetStands(fit, found);
  found.T_cam_board = estimate->T_cam_board;
  if (found.estimates_lens && !fit.sigma.empty()) found.focal_sigma_ratio = FocalSigma_ratio(fit);
}

}  // namespace

std::vector<std::string> EmptySides(const Coverage& coverage) {
  std::vector<std::string> sides;
  for (std::size_t side = 0; side < kSidesOfPicture.size(); ++side)
    if (coverage.margin_ratio[side] > kEmptyMargin_ratio) sides.emplace_back(kSidesOfPicture[side]);
  return sides;
}

const Target* BestTarget(const std::vector<const Target*>& targets, const Pictures& pictures) {
  const Target* best = nullptr;
  for (const Target* target : targets)
    if (best == nullptr || FoundIn(pictures, target->id) > FoundIn(pictures, best->id)) best = target;
  return best;
}

std::vector<std::pair<CaptureId, BoardView>> ViewsOf(const Pictures& pictures, const TargetId& target) {
  std::vector<std::pair<CaptureId, BoardView>> views;
  for (const auto& [capture, picture] : pictures)
    if (const TargetSeen* seen = SeenOf(picture, target)) views.emplace_back(capture, seen->view);
  return views;
}

CameraFound FindCamera(const Sensor& camera, const std::vector<const Target*>& targets, const Pictures& pictures,
                       calib::CameraMemory& lenses) {
  CameraFound found;
  found.camera = camera.id;
  found.estimates_lens = !camera.intrinsics;
  found.fills_picture = IsPinhole(calib::ModelOf(camera));
  SetSizes(pictures, found);
  for (const Target* target : targets) found.boards.push_back({*target, FoundIn(pictures, target->id)});
  const Target* board = BestTarget(targets, pictures);
  if (board == nullptr) return found;
  found.board = *board;
  SetFound(pictures, found);
  SetSharpness(pictures, found);
  const calib::CameraProblem problem{camera, *board, ViewsOf(pictures, board->id)};
  found.coverage = CoverageOf(calib::SeenBy(problem));
  if (!found.with_board.empty()) SetLens(problem, lenses, found);
  return found;
}

}  // namespace rigcal::check
