#include "server/fleet/causes/rig_causes.h"

#include <algorithm>

#include "server/fleet/causes/placed_sensors.h"
#include "server/fleet/wording.h"
#include "server/model/edges/past.h"

namespace rigcal::fleet {
namespace {

// Sensors that a session lists or an edge names, past ones and all.
std::set<SensorId> SensorsHere(const CauseSearch& search) {
  std::set<SensorId> here;
  for (const SensorPose& pose : search.solution.poses) here.insert(pose.sensor);
  for (const auto& [session, header] : search.headers)
    for (const Sensor& sensor : header.sensors) here.insert(sensor.id);
  for (const Edge& edge : search.edges) here.insert({edge.frame_a, edge.frame_b});
  return here;
}

std::string IsInModelText(const std::vector<SensorId>& missing, const RigModel& model) {
  return List(missing) + (missing.size() == 1 ? " is" : " are") + " in rig model " + model.name + " but not here";
}

std::string WithArticle(SensorKind kind) {
  return kind == SensorKind::kPoseStream ? "a pose stream" : "a " + NameOf(kind);
}

void AddKindCause(const ExpectedSensor& expected, const Sensor& found, CauseSearch& search) {
  RootCause cause;
  cause.kind = CauseKind::kSensorKind;
  cause.sensors = {expected.id};
  cause.said = {expected.id.str() + " is " + WithArticle(expected.kind) + " in rig model " +
                    search.expected.model.name + " but " + WithArticle(found.kind) + " here",
                "Correct its type in session.yaml, or in the rig model"};
  cause.command = "rigcal push FOLDER";
  search.causes.push_back(std::move(cause));
}

void FindKinds(CauseSearch& search) {
  const std::vector<const SessionHeader*> newest = NewestFirst(search.headers);
  for (const ExpectedSensor& expected : search.expected.model.sensors)
    for (const SessionHeader* header : newest) {
      const Sensor* found = SensorOf(*header, expected.id);
      if (found == nullptr) continue;
      if (found->kind != expected.kind) AddKindCause(expected, *found, search);
      break;
    }
}

bool IsCalibratedPair(const std::vector<Edge>& edges, const SensorPair& pair) {
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    return edge.state == EdgeState::kGood && std::minmax(edge.frame_a, edge.frame_b) == std::minmax(pair.a, pair.b);
  });
}

std::string RequiredPairsText(const std::vector<SensorPair>& pairs) {
  std::vector<std::string> names;
  for (const SensorPair& pair : pairs) names.push_back(pair.a.str() + " - " + pair.b.str());
  return List(names);
}

RootCause OffModel(const Placed& placed, const Vector6d& off, const PoseLimit& tolerance, const std::string& model) {
  RootCause cause;
  cause.kind = CauseKind::kOffRigModel;
  cause.sensors = {placed.sensor};
  cause.said = {placed.sensor.str() + " sits " + OffText(off) + " from where rig model " + model + " has it (" +
                    LimitText(tolerance) + " allowed)" + ByMeasuredText(placed),
                "Check the mount of " + placed.sensor.str() + ", or correct the rig model"};
  return cause;
}

// From where the rig model has it; of what is open, as near to that as it goes.
void FindOffModel(const Placed& placed, const ExpectedSensor& expected, CauseSearch& search) {
  const PoseLimit& tolerance = expected.tolerance;
  const Vector6d off = Away(placed.drawn, NearestTo(placed, placed.drawn, {tolerance.m, tolerance.rad}));
  if (IsBeyond(off, tolerance)) search.causes.push_back(OffModel(placed, off, tolerance, search.expected.model.name));
}

}  // namespace

void FindSensorsMissing(CauseSearch& search) {
  const RigModel& model = search.expected.model;
  if (model.name.empty()) return;
  const std::set<SensorId> here = SensorsHere(search);
  RootCause cause;
  cause.kind = CauseKind::kSensorMissing;
  for (const ExpectedSensor& expected : model.sensors)
    if (!here.contains(expected.id) && !search.retired.contains(expected.id)) cause.sensors.push_back(expected.id);
  if (!cause.sensors.empty()) {
    cause.said = {IsInModelText(cause.sensors, model),
                  "Capture " + List(cause.sensors) + " too, or correct the rig model"};
    search.causes.push_back(std::move(cause));
  }
  FindKinds(search);
}

void FindPairsMissing(CauseSearch& search) {
  const RigModel& model = search.expected.model;
  const std::set<SensorId> here = SensorsHere(search);
  std::vector<SensorPair> missing;
  RootCause cause;
  cause.kind = CauseKind::kPairMissing;
  std::set<SensorId> named;
  for (const SensorPair& pair : model.required_pairs) {
    const bool asked = here.contains(pair.a) && here.contains(pair.b) && !search.retired.contains(pair.a) &&
                       !search.retired.contains(pair.b);
    if (!asked || IsCalibratedPair(search.edges, pair)) continue;  // of a sensor that is missing that is said
    missing.push_back(pair);
    for (const SensorId& sensor : {pair.a, pair.b})
      if (named.insert(sensor).second) cause.sensors.push_back(sensor);
  }
  if (missing.empty()) return;
  cause.said = {"rig model " + model.name + " requires " + RequiredPairsText(missing) + ", which " +
                    (missing.size() == 1 ? "has" : "have") + " no good edge here",
                "Capture " + RequiredPairsText(missing) + " together, with the same target in view"};
  cause.command = "rigcal push FOLDER";
  search.causes.push_back(std::move(cause));
}

void FindOffRigModel(CauseSearch& search) {
  const RigModel& model = search.expected.model;
  const SensorPose* reference = ReferenceOf(search.solution);
  const bool any_drawn = std::any_of(model.sensors.begin(), model.sensors.end(),
                                     [](const ExpectedSensor& sensor) { return sensor.T_ref_sensor.has_value(); });
  if (reference == nullptr || !any_drawn) return;
  if (!NominalPose(model, reference->sensor, reference->sensor)) {
    RootCause cause;
    cause.kind = CauseKind::kReferenceNotDrawn;
    cause.sensors = {reference->sensor};
    cause.said = {reference->sensor.str() + ", from which all poses are told, has no place in rig model " + model.name +
                      ", so that no pose is held against it",
                  "Give " + reference->sensor.str() + " a T_ref_sensor in the rig model"};
    return search.causes.push_back(std::move(cause));
  }
  const std::set<SensorId> told = MisplacedBy(search.causes);
  for (const SensorPose& pose : search.solution.poses) {
    const auto drawn = NominalPose(model, reference->sensor, pose.sensor);
    if (pose.Placed() == nullptr || !drawn || pose.sensor == reference->sensor || told.contains(pose.sensor)) continue;
    const ExpectedSensor* expected = SensorOf(model, pose.sensor == model.reference ? reference->sensor : pose.sensor);
    FindOffModel({pose.sensor, expected->kind, *pose.Placed(), *drawn, 0.0, pose.unobservable_basis}, *expected,
                 search);
  }
}

std::string LackingOf(const SessionHeader& header, const RigModel& model, const std::set<SensorId>& retired) {
  std::vector<SensorId> missing;
  for (const ExpectedSensor& expected : model.sensors)
    if (SensorOf(header, expected.id) == nullptr && !retired.contains(expected.id)) missing.push_back(expected.id);
  return missing.empty() ? "" : IsInModelText(missing, model);
}

}  // namespace rigcal::fleet
