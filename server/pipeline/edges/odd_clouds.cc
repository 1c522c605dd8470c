#include "server/pipeline/edges/odd_clouds.h"

namespace rigcal::pipeline {

void OddClouds::Add(const SensorId& lidar, const CaptureId& capture, const std::string& what) {
  if (!what.empty()) odd_[lidar].emplace(capture, what);
}

std::vector<Diagnosis> OddClouds::Notes() const {
  std::vector<Diagnosis> notes;
  for (const auto& [lidar, captures] : odd_) {
    const auto& [capture, what] = *captures.begin();
    const std::size_t count = captures.size();
    notes.push_back(
        {"odd_cloud",
         (count == 1 ? "Cloud " : std::to_string(count) + " clouds of " + lidar.str() + " are odd, first ") +
             lidar.str() + "/" + capture.str() + ": " + what + ".",
         "Look at it in a viewer; clouds are in metres, and of a .bin session.yaml's fields and point_type "
         "say what it holds."});
  }
  return notes;
}

}  // namespace rigcal::pipeline
