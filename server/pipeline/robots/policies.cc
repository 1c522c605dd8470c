#include "server/pipeline/robots/policies.h"

#include <algorithm>
#include <cstdint>
#include <set>

#include "server/base/text.h"
#include "server/formats/answers/answers.h"
#include "server/formats/yaml/policy_yaml.h"
#include "server/pipeline/edges/camera_fits.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/unknown_names.h"
#include "storage/sessions/retired.h"
#include "storage/settings/policies.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

// A robot's places, the widest first.
std::vector<PolicyPlace> PlacesOf(const PolicyPlace& place, const std::string& rig_model) {
  std::vector<PolicyPlace> places = {{PolicyScope::kFleet, ""}};
  if (!rig_model.empty()) places.push_back({PolicyScope::kModel, rig_model});
  if (place.scope == PolicyScope::kRobot) places.push_back(place);
  return places;
}

Result<std::string> RigModelOf(storage::Store& store, const PolicyPlace& place) {
  if (place.scope == PolicyScope::kRobot) return storage::LoadRigModel(store, RobotId(place.subject));
  return place.subject;
}

std::int64_t& VersionIn(PolicyInForce& in_force, PolicyScope scope) {
  if (scope == PolicyScope::kFleet) return in_force.fleet;
  return scope == PolicyScope::kModel ? in_force.model : in_force.robot;
}

// What holds, and as whom it was set: the widest first.
struct Holding {
  PolicyInForce in_force;
  std::vector<PolicyVersion> set;
};

Result<Holding> LoadHolding(storage::Store& store, const PolicyPlace& place) {
  Holding holding;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(holding.in_force.watermark, storage::LoadPolicyWatermark(store));
    RIGCAL_ASSIGN(holding.in_force.rig_model, RigModelOf(store, place));
    for (const PolicyPlace& one : PlacesOf(place, holding.in_force.rig_model)) {
      RIGCAL_ASSIGN(auto version, storage::LoadPolicy(store, one));
      if (version) holding.set.push_back(std::move(*version));
    }
    return {};
  }));
  for (const PolicyVersion& one : holding.set) {
    RIGCAL_ASSIGN(const Policy narrow, formats::ReadStoredPolicy(one.text, "the policy of " + TextOf(one.place)));
    holding.in_force.policy = Overlaid(holding.in_force.policy, narrow);
    VersionIn(holding.in_force, one.place.scope) = one.version;
  }
  return holding;
}

bool SaysPixels(const Policy& policy) {
  return policy.all.tolerance_px_at_10_m ||
         std::any_of(policy.sensors.begin(), policy.sensors.end(),
                     [](const auto& one) { return one.second.tolerance_px_at_10_m.has_value(); });
}

// A rig model is named freely, in one line.
Result<PolicyPlace> ModelNamed(const std::string& model) {
  constexpr std::size_t kModelBytesMax = 1024;
  if (!model.empty() && model.size() <= kModelBytesMax && IsPrintableUtf8(model))
    return PolicyPlace{PolicyScope::kModel, model};
  return Fail(ErrorCode::kInvalidInput, Quoted(model) + " is no rig model", "Give what session.yaml has as rig_model.");
}

Result<PolicyPlace> PlaceAsked(storage::Store& store, const Parameters& parameters) {
  const auto model = parameters.Text("model");
  if (!parameters.Text("robot")) return model ? ModelNamed(*model) : PolicyPlace{};
  if (model)
    return Fail(ErrorCode::kInvalidInput, "a policy is of a robot or of a rig model, not of both", "Give one of them.");
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(store, parameters));
  return PolicyPlace{PolicyScope::kRobot, robot.str()};
}

// Those of which it is not known when they were captured come last.
std::vector<const SessionHeader*> NewestFirst(const std::map<SessionId, SessionHeader>& headers,
                                              const std::map<SessionId, Stamp>& captured_at) {
  std::vector<std::pair<std::int64_t, const SessionHeader*>> timed;
  for (const auto& [session, header] : headers) {
    const auto found = captured_at.find(session);
    timed.emplace_back(found == captured_at.end() ? INT64_MIN : found->second.ns, &header);
  }
  std::stable_sort(timed.begin(), timed.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<const SessionHeader*> sorted;
  for (const auto& [captured_ns, header] : timed) sorted.push_back(header);
  return sorted;
}

std::set<SensorId> SensorsNamedBy(const Policy& policy) {
  std::set<SensorId> sensors;
  for (const auto& [sensor, words] : policy.sensors) sensors.insert(sensor);
  for (const auto& [pair, words] : policy.pairs) sensors.insert({pair.a, pair.b});
  return sensors;
}

// Sensors that are retired may come back.
Status CheckSensorsNamed(storage::Store& store, const RobotId& robot, const Policy& policy) {
  for (const SensorId& sensor : SensorsNamedBy(policy)) {
    RIGCAL_ASSIGN(const bool is_known, storage::HasSensor(store, robot, sensor));
    if (is_known) continue;
    RIGCAL_ASSIGN(const auto known, LoadSensorNames(store, robot));
    return Fail(UnknownSensor(robot, sensor, {known.begin(), known.end()}));
  }
  return {};
}

// A misspelt name would hold for nobody, and nobody would notice.
Status CheckNamesIn(storage::Store& store, const Parameters& parameters, const PolicyPlace& place,
                    const Policy& policy) {
  RIGCAL_ASSIGN(const bool is_new_model, parameters.Flag("new_model"));
  if (place.scope == PolicyScope::kRobot) return CheckSensorsNamed(store, RobotId(place.subject), policy);
  if (place.scope == PolicyScope::kFleet || is_new_model) return {};
  RIGCAL_ASSIGN(const bool is_known, storage::HasRigModel(store, place.subject));
  return is_known ? Status() : Fail(UnknownModel(store, place.subject));
}

}  // namespace

Result<PolicyInForce> LoadPolicyInForce(storage::Store& store, const PolicyPlace& place) {
  RIGCAL_ASSIGN(Holding holding, LoadHolding(store, place));
  return std::move(holding.in_force);
}

Status TakeFocals(storage::Store& store, const std::vector<Edge>& edges,
                  const std::map<SessionId, SessionHeader>& headers, const std::map<SessionId, Stamp>& captured_at,
                  Policy& policy) {
  if (!SaysPixels(policy)) return {};
  formats::RevisionInput of_edges;
  of_edges.edges = edges;
  RIGCAL_ASSIGN(const auto cameras, LoadFits(store, report::ChooseFits(of_edges, captured_at)));
  for (const report::CameraReport& camera : cameras)
    if (camera.fit.source != IntrinsicsSource::kNone)
      policy.focal_px.emplace(camera.fit.camera, AxialFocal_px(camera.fit.intrinsics));
  for (const SessionHeader* header : NewestFirst(headers, captured_at))
    for (const Sensor& sensor : header->sensors)
      if (sensor.intrinsics) policy.focal_px.emplace(sensor.id, AxialFocal_px(*sensor.intrinsics));
  return {};
}

Result<std::string> TellPolicy(storage::Store& store, const Parameters& parameters) {
  RIGCAL_ASSIGN(const PolicyPlace place, PlaceAsked(store, parameters));
  RIGCAL_ASSIGN(const Holding holding, LoadHolding(store, place));
  return formats::WritePolicy({place, holding.in_force, holding.set});
}

Result<OrderDone> SetPolicy(storage::Store& store, const Clock& clock, const Parameters& parameters) {
  RIGCAL_ASSIGN(const Word word, RequiredWord(parameters, clock.Now(), "Say who sets it.", "Say why these limits."));
  RIGCAL_ASSIGN(const PolicyPlace place, PlaceAsked(store, parameters));
  const std::string text = parameters.Text("text").value_or("");
  RIGCAL_ASSIGN(const Policy policy, formats::ReadPolicy(text, "the policy of " + TextOf(place)));
  RIGCAL_TRY(CheckNamesIn(store, parameters, place, policy));
  PolicyVersion set;
  std::int64_t waiting = 0;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(set, storage::AppendPolicy(store, place, text, word));
    RIGCAL_ASSIGN(waiting, storage::CountRobotsToJudge(store, set.number));
    return {};
  }));
  const RobotId robot(place.scope == PolicyScope::kRobot ? place.subject : "");
  return OrderDone{robot, formats::WritePolicySet(set, waiting)};
}

}  // namespace rigcal::pipeline
