#include "server/report/text/edge_state.h"

#include "server/model/edges/past.h"

namespace rigcal::report {

bool HasFailed(const Edge& edge) { return edge.state == EdgeState::kFailed && !IsPast(edge); }

const char* StateWord(const Edge& edge) {
  if (edge.state == EdgeState::kGood) return "good";
  return IsPast(edge) ? "past" : "failed";
}

const char* StateLevel(const Edge& edge) {
  if (edge.state == EdgeState::kGood) return "pass";
  return IsPast(edge) ? "unknown" : "fail";
}

}  // namespace rigcal::report
