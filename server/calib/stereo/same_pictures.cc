#include "server/calib/stereo/same_pictures.h"

#include <algorithm>

#include "server/calib/core/diagnoses.h"

namespace rigcal::calib {

void LeaveOut(const std::vector<CaptureId>& same, StereoProblem& problem) {
  std::erase_if(problem.captures, [&](const StereoCapture& capture) {
    return std::find(same.begin(), same.end(), capture.capture) != same.end();
  });
}

void TellLeftOut(const std::vector<CaptureId>& same, Edge& edge) {
  if (same.empty()) return;
  const Diagnosis note = {
      "same_picture",
      edge.frame_a.str() + " and " + edge.frame_b.str() +
          " have one and the same file in these captures, which are not used: " + NamesOf(same) + ".",
      "Copy each camera's own pictures into its folder and push the session again."};
  edge.diagnoses.insert(edge.diagnoses.begin(), note);
  for (const CaptureId& capture : same)
    edge.captures.push_back({capture, 0.0, false, "both sensors have the same file"});
  std::stable_sort(edge.captures.begin(), edge.captures.end(),
                   [](const CaptureResidual& a, const CaptureResidual& b) { return a.capture < b.capture; });
}

}  // namespace rigcal::calib
