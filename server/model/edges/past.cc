#include "server/model/edges/past.h"

#include <algorithm>

namespace rigcal {

bool MeansPast(std::string_view diagnosis_code) {
  return diagnosis_code == kSupersededCode || diagnosis_code == kRemountedCode || diagnosis_code == kRetiredCode ||
         diagnosis_code == kSensorRetiredCode || diagnosis_code == kEpochCode;
}

bool IsPast(const Edge& edge) {
  return edge.state == EdgeState::kFailed && !edge.diagnoses.empty() && MeansPast(edge.diagnoses.front().code);
}

bool IsOfEarlierEpoch(const Edge& edge) {
  if (!IsPast(edge)) return false;
  const std::string& code = edge.diagnoses.front().code;
  return code == kRemountedCode || code == kEpochCode;
}

bool AsksForNoSensor(const Edge& edge) { return IsPast(edge) && !IsOfEarlierEpoch(edge); }

bool FailedForLostFile(const Edge& edge) {
  return edge.state == EdgeState::kFailed && !edge.diagnoses.empty() && edge.diagnoses.front().code == kFileLostCode;
}

void AddRemounted(SensorId sensor, SessionHeader& header) {
  const auto place = std::lower_bound(header.remounted.begin(), header.remounted.end(), sensor);
  if (place == header.remounted.end() || *place != sensor) header.remounted.insert(place, std::move(sensor));
}

}  // namespace rigcal
