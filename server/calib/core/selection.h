// Which captures enter the joint problem, and why the others do not.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/calib/camera/camera_start.h"
#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/joint_problem.h"
#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

// A capture that both cameras saw always enters. One that a single camera saw enters unless that camera's intrinsics
// are held, as it tells about them and about nothing else. A capture that shows what an earlier one shows does not
// enter: as a block of its own it would make the jackknife believe in information that is not there.
struct Selection {
  std::vector<std::size_t> used;              // indices into StereoProblem::captures, ascending
  std::map<std::size_t, std::string> unused;  // index, and why in words
  std::vector<CaptureId> repeated;            // the unused ones that repeat another, sorted
};

// The model of its given intrinsics, or the one they are to be estimated as.
[[nodiscard]] CameraModel ModelOf(const Sensor& camera);
// Found, with enough points of this board: see WhyUnusable.
[[nodiscard]] bool Sees(const std::optional<BoardView>& view, const Target& board);
[[nodiscard]] bool BothSee(const StereoCapture& capture, const Target& board);
// One camera of a pair (&StereoCapture::a or b), and with its views by itself.
[[nodiscard]] const Sensor& SensorOf(const StereoProblem& problem, std::optional<BoardView> StereoCapture::*camera);
[[nodiscard]] CameraProblem CameraOf(const StereoProblem& problem, std::optional<BoardView> StereoCapture::*camera);
[[nodiscard]] std::set<CaptureId> SeenByBoth(const StereoProblem& problem);
[[nodiscard]] Selection Select(const StereoProblem& problem);

// How many of those at the indices `used` show the board to both cameras.
[[nodiscard]] std::size_t CountBoth(const StereoProblem& problem, const std::vector<std::size_t>& used);
// `turn_b`: of the views of b, as in StereoEstimate. Corners are taken as typical until SetCornerSigma says otherwise.
[[nodiscard]] JointProblem JointOf(const StereoProblem& problem, const std::vector<std::size_t>& used,
                                   const std::map<CaptureId, int>& turn_b = {});
// What corners count against intrinsics that were given with sigmas.
void SetCornerSigma(const StereoProblem& problem, double corner_sigma_px, JointProblem& joint);
[[nodiscard]] CameraViews ViewsOf(const StereoProblem& problem, const std::vector<std::size_t>& used,
                                  std::optional<BoardView> StereoCapture::*camera);

// Captures whose picture, of those that count, is not as large as the camera's first.
template <typename Counts>
[[nodiscard]] std::vector<CaptureId> Resized(const CameraProblem& problem, const Counts& counts) {
  std::vector<CaptureId> resized;
  const BoardView* first = nullptr;
  for (const auto& [capture, view] : problem.views) {
    if (!counts(view)) continue;
    if (first == nullptr) first = &view;
    if (view.image_width_px != first->image_width_px || view.image_height_px != first->image_height_px)
      resized.push_back(capture);
  }
  return resized;
}

// The usable ones of a camera by itself, for its own model.
[[nodiscard]] CameraViews ViewsOf(const CameraProblem& problem);

// The points that both show are at the same places (0.5 px rms), in one of the orientations in which the board looks
// alike.
[[nodiscard]] bool ShowSame(const BoardView& left, const BoardView& right, const Target& board);

}  // namespace rigcal::calib
