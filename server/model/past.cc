#include "server/model/past.h"

#include <algorithm>

namespace rigcal {

bool MeansPast(std::string_view diagnosis_code) {
  return diagnosis_code == kSupersededCode || diagnosis_code == kRemountedCode || diagnosis_code == kRetiredCode ||
         diagnosis_code == kSensorRetiredCode;
}

bool IsPast(const Edge& edge) {
  return edge.state == EdgeState::kFailed && !edge.diagnoses.empty() && MeansPast(edge.diagnoses.front().code);
}

bool AsksForNoSensor(const Edge& edge) { return IsPast(edge) && edge.diagnoses.front().code != kRemountedCode; }

bool FailedForLostFile(const Edge& edge) {
  return edge.state == EdgeState::kFailed && !edge.diagnoses.empty() && edge.diagnoses.front().code == kFileLostCode;
}

void AddRemounted(SensorId sensor, SessionHeader& header) {
  const auto place = std::lower_bound(header.remounted.begin(), header.remounted.end(), sensor);
  if (place == header.remounted.end() || *place != sensor) header.remounted.insert(place, std::move(sensor));
}

}  // namespace rigcal
