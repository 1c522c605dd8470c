#include "server/calib/selection.h"

#include <algorithm>
#include <cmath>

#include "server/calib/board_points.h"

namespace rigcal::calib {
namespace {

using View = std::optional<BoardView>;

// Noise of a resting board is some tenths of this; a hand cannot repeat a pose this well.
constexpr double kSameViewRms_px = 0.5;

std::string WhyNot(const View& view, const SensorId& camera) {
  if (!view) return camera.str() + ": no picture";
  return camera.str() + ": " + (view->why_not.empty() ? "no board" : view->why_not);
}

bool ShowSame(const BoardView& left, const BoardView& right) {
  double sum = 0;
  for (std::size_t i = 0; i < left.corners_px.size(); ++i)
    sum += (left.corners_px[i] - right.corners_px[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(left.corners_px.size())) < kSameViewRms_px;
}

// Every view of `capture` is also in `earlier`.
bool Repeats(const StereoCapture& capture, const StereoCapture& earlier, const Checkerboard& board) {
  const auto repeated = [&](const View& view, const View& before) {
    return !Sees(view, board) || (Sees(before, board) && ShowSame(*view, *before));
  };
  return repeated(capture.a, earlier.a) && repeated(capture.b, earlier.b);
}

// Empty: it enters.
std::string WhyUseless(const StereoProblem& problem, const StereoCapture& capture) {
  const bool a = Sees(capture.a, problem.board), b = Sees(capture.b, problem.board);
  if (a && b) return {};
  const std::string missing =
      !a && !b ? WhyNot(capture.a, problem.camera_a.id) + "; " + WhyNot(capture.b, problem.camera_b.id)
      : !a     ? WhyNot(capture.a, problem.camera_a.id)
               : WhyNot(capture.b, problem.camera_b.id);
  const bool informs_intrinsics = (a && !problem.camera_a.intrinsics) || (b && !problem.camera_b.intrinsics);
  return informs_intrinsics ? std::string() : missing;
}

CameraViews ViewsOf(const StereoProblem& problem, const std::vector<std::size_t>& used, View StereoCapture::*camera) {
  CameraViews views;
  views.corners_board = BoardPoints(problem.board);
  for (const std::size_t idx : used) {
    const View& view = problem.captures[idx].*camera;
    if (!Sees(view, problem.board)) continue;
    views.width_px = view->image_width_px;
    views.height_px = view->image_height_px;
    views.corners_px.push_back(view->corners_px);
  }
  return views;
}

}  // namespace

bool Sees(const View& view, const Checkerboard& board) {
  if (!view || !view->found) return false;
  if (view->corners_px.size() != static_cast<std::size_t>(board.inner_cols * board.inner_rows)) return false;
  return std::all_of(view->corners_px.begin(), view->corners_px.end(),
                     [](const Eigen::Vector2d& uv_px) { return uv_px.allFinite(); });
}

bool BothSee(const StereoCapture& capture, const Checkerboard& board) {
  return Sees(capture.a, board) && Sees(capture.b, board);
}

std::vector<CaptureId> MissedBy(const StereoProblem& problem, View StereoCapture::*camera) {
  std::vector<CaptureId> missed;
  for (const StereoCapture& capture : problem.captures)
    if (!Sees(capture.*camera, problem.board)) missed.push_back(capture.capture);
  return missed;
}

Selection Select(const StereoProblem& problem) {
  Selection selection;
  // Captures of both cameras first: a single view that repeats one of them adds nothing, the reverse does.
  for (const bool both : {true, false}) {
    for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
      const StereoCapture& capture = problem.captures[idx];
      if (BothSee(capture, problem.board) != both) continue;
      if (std::string why = WhyUseless(problem, capture); !why.empty()) {
        selection.unused[idx] = std::move(why);
        continue;
      }
      const auto earlier = std::find_if(selection.used.begin(), selection.used.end(), [&](std::size_t other) {
        return Repeats(capture, problem.captures[other], problem.board);
      });
      if (earlier == selection.used.end()) {
        selection.used.push_back(idx);
      } else {
        selection.unused[idx] = "shows the same as " + problem.captures[*earlier].capture.str();
        selection.repeated.push_back(idx);
      }
    }
  }
  std::sort(selection.used.begin(), selection.used.end());
  std::sort(selection.repeated.begin(), selection.repeated.end());
  return selection;
}

std::size_t CountBoth(const StereoProblem& problem, const std::vector<std::size_t>& used) {
  return static_cast<std::size_t>(std::count_if(
      used.begin(), used.end(), [&](std::size_t idx) { return BothSee(problem.captures[idx], problem.board); }));
}

JointProblem JointOf(const StereoProblem& problem, const std::vector<std::size_t>& used) {
  JointProblem joint;
  joint.corners_board = BoardPoints(problem.board);
  joint.estimate_a = !problem.camera_a.intrinsics;
  joint.estimate_b = !problem.camera_b.intrinsics;
  for (const std::size_t idx : used) {
    const StereoCapture& capture = problem.captures[idx];
    JointCapture views;
    // A single view of a camera with given intrinsics never comes here, so no view is idle.
    if (Sees(capture.a, problem.board)) views.a_px = capture.a->corners_px;
    if (Sees(capture.b, problem.board)) views.b_px = capture.b->corners_px;
    joint.captures.push_back(std::move(views));
  }
  return joint;
}

CameraViews ViewsOfA(const StereoProblem& problem, const std::vector<std::size_t>& used) {
  return ViewsOf(problem, used, &StereoCapture::a);
}

CameraViews ViewsOfB(const StereoProblem& problem, const std::vector<std::size_t>& used) {
  return ViewsOf(problem, used, &StereoCapture::b);
}

}  // namespace rigcal::calib
