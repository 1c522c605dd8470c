#include "server/model/edges/unit_doubt.h"

#include <cstdio>

namespace rigcal {
namespace {

using Positions = std::map<std::string, Eigen::Vector3d>;

struct Stretch {
  double distance_m = 0.0;
  std::string between;  // "front_left and top"
};

void Widen(double distance_m, const std::string& a, const std::string& b, Stretch& widest) {
  if (distance_m > widest.distance_m) widest = {distance_m, a + " and " + b};
}

std::string QuestionOf(const Stretch& widest) {
  char metres[32];
  std::snprintf(metres, sizeof metres, widest.distance_m < 1e6 ? "%.0f" : "%.3g", widest.distance_m);
  return std::string(metres) + " m between " + widest.between + ": are these millimetres?";
}

std::string QuestionBeyond(double doubted_m, const Stretch& widest) {
  return widest.distance_m > doubted_m ? QuestionOf(widest) : "";
}

Stretch WidestOf(const Positions& p_m) {
  Stretch widest;
  for (auto a = p_m.begin(); a != p_m.end(); ++a)
    for (auto b = std::next(a); b != p_m.end(); ++b) Widen((a->second - b->second).norm(), a->first, b->first, widest);
  return widest;
}

// The reference sensor need not be drawn.
Positions DrawnPositions(const SessionHeader& header) {
  Positions p_m = {{header.reference.str(), Eigen::Vector3d::Zero()}};
  for (const Sensor& sensor : header.sensors)
    if (sensor.T_ref_nominal) p_m[sensor.id.str()] = sensor.T_ref_nominal->p_m;
  return p_m;
}

Stretch LongestStep(const PoseTable& tracker) {
  Stretch longest;
  for (std::size_t i = 1; i < tracker.size(); ++i)
    Widen((tracker[i].T_world_body.p_m - tracker[i - 1].T_world_body.p_m).norm(),
          "captures " + tracker[i - 1].capture.str(), tracker[i].capture.str(), longest);
  return longest;
}

}  // namespace

std::string UnitDoubt(const std::map<std::string, Eigen::Vector3d>& p_m) {
  return QuestionBeyond(kSensorsApartDoubted_m, WidestOf(p_m));
}

std::string UnitDoubt(const SessionHeader& header) { return UnitDoubt(DrawnPositions(header)); }

std::string UnitDoubt(const std::vector<Edge>& edges) {
  Stretch widest;
  for (const Edge& edge : edges)
    if (edge.state == EdgeState::kGood) Widen(edge.T_a_b.p_m.norm(), edge.frame_a.str(), edge.frame_b.str(), widest);
  return QuestionBeyond(kSensorsApartDoubted_m, widest);
}

double LongestStep_m(const PoseTable& tracker) { return LongestStep(tracker).distance_m; }

std::string UnitDoubt(const PoseTable& tracker) { return QuestionBeyond(kTrackerStepDoubted_m, LongestStep(tracker)); }

std::map<std::string, std::string> UnitDoubts(const SessionHeader& header, const std::map<SensorId, PoseTable>& poses) {
  std::map<std::string, std::string> doubts;
  const auto add = [&](const std::string& file, std::string doubt) {
    if (!doubt.empty()) doubts.emplace(file, std::move(doubt));
  };
  add("session.yaml", UnitDoubt(header));
  for (const auto& [id, table] : poses) {
    const Sensor* sensor = SensorOf(header, id);
    if (sensor == nullptr || sensor->kind != SensorKind::kTracker) continue;
    add(id.str() + "/" + std::string(kPoseTableStem) + ".csv", UnitDoubt(table));
  }
  return doubts;
}

Status CheckSensorsApart(const SessionHeader& header) {
  const Stretch widest = WidestOf(DrawnPositions(header));
  if (widest.distance_m <= kSensorsApartMax_m) return {};
  return Fail(ErrorCode::kInvalidInput, "T_ref_nominal: " + QuestionOf(widest), "Give p_m in metres.");
}

}  // namespace rigcal
