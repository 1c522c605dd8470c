#include "server/model/past.h"

namespace rigcal {

bool MeansPast(std::string_view diagnosis_code) {
  return diagnosis_code == "superseded" || diagnosis_code == "remounted";
}

bool IsPast(const Edge& edge) {
  return edge.state == EdgeState::kFailed && !edge.diagnoses.empty() && MeansPast(edge.diagnoses.front().code);
}

}  // namespace rigcal
