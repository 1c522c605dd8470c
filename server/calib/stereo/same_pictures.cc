#include "server/calib/stereo/same_pictures.h"

#include <algorithm>
#include <map>

#include "server/calib/core/diagnoses.h"

namespace rigcal::calib {
namespace {

// Places in the list of captures that figures tell, by the names of the captures.
std::map<std::string, CaptureId> CapturesTold(const Edge& edge) {
  std::map<std::string, CaptureId> told;
  for (const char* figure : {"first_unreadable_a_idx", "first_unreadable_b_idx"})
    if (const auto found = edge.figures.find(figure); found != edge.figures.end())
      told[figure] = edge.captures.at(static_cast<std::size_t>(found->second)).capture;
  return told;
}

double PlaceInList(const CaptureId& capture, const Edge& edge) {
  const auto found = std::find_if(edge.captures.begin(), edge.captures.end(),
                                  [&](const CaptureResidual& one) { return one.capture == capture; });
  return static_cast<double>(std::distance(edge.captures.begin(), found));
}

}  // namespace

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
  const std::map<std::string, CaptureId> told = CapturesTold(edge);
  for (const CaptureId& capture : same)
    edge.captures.push_back({capture, 0.0, false, "both sensors have the same file"});
  std::stable_sort(edge.captures.begin(), edge.captures.end(),
                   [](const CaptureResidual& a, const CaptureResidual& b) { return a.capture < b.capture; });
  for (const auto& [figure, capture] : told) edge.figures[figure] = PlaceInList(capture, edge);
}

}  // namespace rigcal::calib
