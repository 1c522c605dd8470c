#include "server/formats/answers/answer_rows.h"
#include "server/formats/answers/answers.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {

std::string WriteStandingOfSession(const SessionAnswer& session, bool has_edges) {
  return WriteObject([&](JsonWriter& out) {
    out.Object("session", [&] { WriteSessionMembers(out, session); });
    out.Flag("revision_follows", has_edges);
  });
}

std::string WriteStandingOfEdge(const Edge& edge, const std::optional<Standing>& standing) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", edge.robot.str());
    out.Object("edge", [&] { WriteEdgeRowMembers(out, edge, nullptr); });
    WriteStanding(out, "standing", standing);
  });
}

std::string WriteStandingOfSensor(const RobotId& robot, const SensorId& sensor, const std::optional<Standing>& standing,
                                  bool has_edges) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    out.Text("sensor", sensor.str());
    out.Flag("revision_follows", has_edges);
    WriteStanding(out, "standing", standing);
  });
}

}  // namespace rigcal::formats
