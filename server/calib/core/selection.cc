#include "server/calib/core/selection.h"

#include <algorithm>

#include "server/calib/core/capture_blocks.h"

namespace rigcal::calib {
namespace {

using View = std::optional<BoardView>;

// Noise of a resting board is some tenths of this; a hand cannot repeat a pose this well.
constexpr double kSameViewRms_px = 0.5;

std::string WhyNot(const View& view, const SensorId& camera, const Target& board) {
  if (!view) return camera.str() + ": no picture";
  return camera.str() + ": " + WhyUnusable(*view, board);
}

// Where the point is in the picture, if it is seen.
const Eigen::Vector2d* PlaceOf(const BoardView& view, int idx) {
  const auto at = std::lower_bound(view.corner_idx.begin(), view.corner_idx.end(), idx);
  if (at == view.corner_idx.end() || *at != idx) return nullptr;
  return &view.corners_px[static_cast<std::size_t>(at - view.corner_idx.begin())];
}

bool ShowSameTurned(const BoardView& left, const BoardView& right, const Target& board, int turn) {
  const double limit_px2 = kSameViewRms_px * kSameViewRms_px;
  double sum_px2 = 0;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < right.corner_idx.size(); ++i) {
    const int idx = turn == 0 ? right.corner_idx[i] : TurnedIndex(board, right.corner_idx[i], turn);
    const Eigen::Vector2d* place = PlaceOf(left, idx);
    if (place == nullptr) continue;
    ++shared;
    sum_px2 += (*place - right.corners_px[i]).squaredNorm();
    if (sum_px2 > limit_px2 * static_cast<double>(right.corner_idx.size())) return false;
  }
  return shared >= CornersMin(board) && sum_px2 < limit_px2 * static_cast<double>(shared);
}

// Which cameras of a capture see the board.
struct BoardsInView {
  bool a = false, b = false;
};

std::vector<BoardsInView> WhoSees(const StereoProblem& problem) {
  std::vector<BoardsInView> seen;
  for (const StereoCapture& capture : problem.captures)
    seen.push_back({Sees(capture.a, problem.board), Sees(capture.b, problem.board)});
  return seen;
}

// Every view of capture `idx` is also in `earlier`.
bool Repeats(const StereoProblem& problem, const std::vector<BoardsInView>& seen, std::size_t idx,
             std::size_t earlier) {
  const StereoCapture &capture = problem.captures[idx], &before = problem.captures[earlier];
  if ((seen[idx].a && !seen[earlier].a) || (seen[idx].b && !seen[earlier].b)) return false;
  return (!seen[idx].a || calib::ShowSame(*before.a, *capture.a, problem.board)) &&
         (!seen[idx].b || calib::ShowSame(*before.b, *capture.b, problem.board));
}

// Empty: it enters.
std::string WhyUseless(const StereoProblem& problem, const StereoCapture& capture) {
  const bool a = Sees(capture.a, problem.board), b = Sees(capture.b, problem.board);
  if (a && b) return {};
  const std::string missing = !a && !b ? WhyNot(capture.a, problem.camera_a.id, problem.board) + "; " +
                                             WhyNot(capture.b, problem.camera_b.id, problem.board)
                              : !a ? WhyNot(capture.a, problem.camera_a.id, problem.board)
                                   : WhyNot(capture.b, problem.camera_b.id, problem.board);
  const bool informs_intrinsics =
      (a && !HoldsIntrinsics(problem.camera_a)) || (b && !HoldsIntrinsics(problem.camera_b));
  return informs_intrinsics ? std::string() : missing;
}

int TurnOf(const CaptureId& capture, const std::map<CaptureId, int>& turns) {
  const auto turn = turns.find(capture);
  return turn == turns.end() ? 0 : turn->second;
}

}  // namespace

bool ShowSame(const BoardView& left, const BoardView& right, const Target& board) {
  for (int turn = 0; turn < SymmetryOf(board); ++turn)
    if (ShowSameTurned(left, right, board, turn)) return true;
  return false;
}

CameraModel ModelOf(const Sensor& camera) { return camera.intrinsics ? camera.intrinsics->model : camera.camera_model; }

bool Sees(const View& view, const Target& board) { return view && WhyUnusable(*view, board).empty(); }

bool BothSee(const StereoCapture& capture, const Target& board) {
  return Sees(capture.a, board) && Sees(capture.b, board);
}

const Sensor& SensorOf(const StereoProblem& problem, View StereoCapture::*camera) {
  return camera == &StereoCapture::a ? problem.camera_a : problem.camera_b;
}

CameraProblem CameraOf(const StereoProblem& problem, View StereoCapture::*camera) {
  CameraProblem one{SensorOf(problem, camera), problem.board, {}};
  for (const StereoCapture& capture : problem.captures)
    if (capture.*camera) one.views.emplace_back(capture.capture, *(capture.*camera));
  return one;
}

std::set<CaptureId> SeenByBoth(const StereoProblem& problem) {
  return CapturesOf(problem, [&](const StereoCapture& capture) { return BothSee(capture, problem.board); });
}

Selection Select(const StereoProblem& problem) {
  Selection selection;
  const std::vector<BoardsInView> seen = WhoSees(problem);
  // Captures of both cameras first: a single view that repeats one of them adds nothing, the reverse does.
  for (const bool both : {true, false}) {
    for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
      const StereoCapture& capture = problem.captures[idx];
      if ((seen[idx].a && seen[idx].b) != both) continue;
      if (std::string why = WhyUseless(problem, capture); !why.empty()) {
        selection.unused[idx] = std::move(why);
        continue;
      }
      const auto earlier = std::find_if(selection.used.begin(), selection.used.end(),
                                        [&](std::size_t other) { return Repeats(problem, seen, idx, other); });
      if (earlier == selection.used.end()) {
        selection.used.push_back(idx);
      } else {
        selection.unused[idx] = "shows the same as " + problem.captures[*earlier].capture.str();
        selection.repeated.push_back(capture.capture);
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

JointProblem JointOf(const StereoProblem& problem, const std::vector<std::size_t>& used,
                     const std::map<CaptureId, int>& turn_b) {
  JointProblem joint;
  joint.corners_board = TargetPoints(problem.board);
  joint.a = {ModelOf(problem.camera_a), !HoldsIntrinsics(problem.camera_a), HeldOf(problem.camera_a), {}};
  joint.b = {ModelOf(problem.camera_b), !HoldsIntrinsics(problem.camera_b), HeldOf(problem.camera_b), {}};
  SetCornerSigma(problem, kTypicalCornerSigma_px, joint);
  for (const std::size_t idx : used) {
    const StereoCapture& capture = problem.captures[idx];
    JointCapture views;
    // A single view of a camera whose intrinsics are held never comes here, so no view is idle.
    if (Sees(capture.a, problem.board)) views.a = SeenIn(*capture.a, problem.board);
    if (Sees(capture.b, problem.board)) views.b = SeenIn(*capture.b, problem.board, TurnOf(capture.capture, turn_b));
    joint.captures.push_back(std::move(views));
  }
  return joint;
}

void SetCornerSigma(const StereoProblem& problem, double corner_sigma_px, JointProblem& joint) {
  joint.a.pull = PullOf(problem.camera_a, corner_sigma_px);
  joint.b.pull = PullOf(problem.camera_b, corner_sigma_px);
}

CameraViews ViewsOf(const StereoProblem& problem, const std::vector<std::size_t>& used, View StereoCapture::*camera) {
  CameraProblem one{SensorOf(problem, camera), problem.board, {}};
  for (const std::size_t idx : used)
    if (const View& view = problem.captures[idx].*camera) one.views.emplace_back(problem.captures[idx].capture, *view);
  return ViewsOf(one);
}

CameraViews ViewsOf(const CameraProblem& problem) {
  CameraViews views;
  views.model = ModelOf(problem.camera);
  views.corners_board = TargetPoints(problem.board);
  for (const auto& [capture, view] : problem.views) {
    if (!WhyUnusable(view, problem.board).empty()) continue;
    views.width_px = view.image_width_px;
    views.height_px = view.image_height_px;
    views.seen.push_back(SeenIn(view, problem.board));
  }
  return views;
}

}  // namespace rigcal::calib
