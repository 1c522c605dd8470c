#include "server/pipeline/same_pictures.h"

#include <algorithm>
#include <map>

#include "server/calib/core/diagnoses.h"

namespace rigcal::pipeline {

std::vector<CaptureId> SamePictures(const Manifest& manifest, const SensorPair& pair) {
  std::map<CaptureId, Digest> of_a;
  for (const Payload& payload : manifest.payloads)
    if (payload.sensor == pair.a) of_a.emplace(payload.capture, payload.digest);
  std::vector<CaptureId> same;
  for (const Payload& payload : manifest.payloads) {
    if (payload.sensor != pair.b) continue;
    const auto other = of_a.find(payload.capture);
    if (other != of_a.end() && other->second == payload.digest) same.push_back(payload.capture);
  }
  return same;
}

void LeaveOut(const std::vector<CaptureId>& same, calib::StereoProblem& problem) {
  std::erase_if(problem.captures, [&](const calib::StereoCapture& capture) {
    return std::find(same.begin(), same.end(), capture.capture) != same.end();
  });
}

void TellLeftOut(const std::vector<CaptureId>& same, Edge& edge) {
  if (same.empty()) return;
  const Diagnosis note = {
      "same_picture",
      edge.frame_a.str() + " and " + edge.frame_b.str() +
          " have one and the same file in these captures, which are not used: " + calib::NamesOf(same) + ".",
      "Copy each camera's own pictures into its folder and push the session again."};
  edge.diagnoses.insert(edge.diagnoses.begin(), note);
  for (const CaptureId& capture : same)
    edge.captures.push_back({capture, 0.0, false, "both sensors have the same file"});
  std::stable_sort(edge.captures.begin(), edge.captures.end(),
                   [](const CaptureResidual& a, const CaptureResidual& b) { return a.capture < b.capture; });
}

}  // namespace rigcal::pipeline
