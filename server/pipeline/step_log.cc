#include "server/pipeline/step_log.h"

#include "server/base/log.h"
#include "server/metrics/noted.h"

namespace rigcal::pipeline {

void LogEdge(const Edge& edge) {
  const bool is_good = edge.state == EdgeState::kGood;
  metrics::NoteCalibratedEdge(is_good);
  const std::string why = edge.diagnoses.empty() ? "" : ": " + edge.diagnoses.front().what;
  Log(LogLevel::kInfo, {.event = "edge", .robot = edge.robot.str(), .session = edge.session.str()},
      "robot " + edge.robot.str() + ", session " + edge.session.str() + ": edge " + edge.frame_a.str() + " " +
          edge.frame_b.str() + (is_good ? " is good" : " failed" + why));
}

void LogRevision(const Revision& revision) {
  const std::string verdict = NameOf(revision.verdict.level);
  metrics::NoteRevision(verdict);
  Log(LogLevel::kInfo, {.event = "revision", .robot = revision.robot.str()},
      "robot " + revision.robot.str() + ": revision " + std::to_string(revision.number) + ", " + verdict);
}

}  // namespace rigcal::pipeline
