#include "server/pipeline/orders/orders.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/base/log.h"
#include "server/formats/answers/answers.h"
#include "server/formats/answers/parameters.h"
#include "server/model/approval/decision.h"
#include "server/pipeline/boards/registry.h"
#include "server/pipeline/recomputation/ask.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/rig_models/begin_epoch.h"
#include "server/pipeline/rig_models/rig_models.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/policies.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/sessions/current_edges.h"
#include "storage/access/accounts.h"
#include "storage/edges/edges.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

// What a person says of something.
struct Saying {
  bool retires = false;  // else restores
  Word word;
};

Result<Saying> SayingOf(const Clock& clock, const std::string& verb, const Parameters& parameters) {
  RIGCAL_ASSIGN(std::string who, RequiredWho(parameters, "Say who asks for it."));
  const bool retires = verb == "retire";
  if (retires) RIGCAL_TRY(RequiredText(parameters, "reason", "Say why it is to take no part."));
  return Saying{retires, {clock.Now(), std::move(who), parameters.Text("reason").value_or("")}};
}

// As it is shown from now on.
Result<OrderDone> SayOf(storage::Store& store, const Saying& saying, const EdgeId& id) {
  RIGCAL_ASSIGN(const auto edge, storage::LoadEdge(store, id));
  if (!edge)
    return Fail(ErrorCode::kNotFound, "edge " + id.str() + " is of a batch that is not whole: it does not count",
                "There is nothing to retire; push the batch again, then retire the edge.");
  RIGCAL_TRY(saying.retires ? storage::RetireEdge(store, id, saying.word)
                            : storage::RestoreEdge(store, id, saying.word));
  RIGCAL_ASSIGN(const auto counts, storage::LoadWhatCounts(store, edge->robot));
  RIGCAL_ASSIGN(const auto standing, storage::LoadStanding(store, id));
  std::vector<Edge> shown = {*edge};
  RIGCAL_TRY(MarkPast(store, counts, shown));
  return OrderDone{edge->robot, formats::WriteStandingOfEdge(shown.front(), standing)};
}

Result<OrderDone> SayOf(storage::Store& store, const Saying& saying, const SessionId& id) {
  if (saying.retires) {
    RIGCAL_TRY(storage::RetireSession(store, id, saying.word));
  } else {
    RIGCAL_TRY(storage::MakeCurrent(store, id, storage::MadeCurrent::kRestored, saying.word));
  }
  RIGCAL_ASSIGN(const auto row, LoadSessionRow(store, id));
  RIGCAL_ASSIGN(const std::int64_t newest_edge, storage::LoadEdgeWatermark(store, row.robot));
  return OrderDone{row.robot, formats::WriteStandingOfSession(row, newest_edge > 0)};
}

// By edges, however many lie between; the reference itself too.
std::set<SensorId> TiedToReference(const Graph& graph) {
  std::multimap<SensorId, SensorId> neighbours;
  for (const GraphEdge& edge : graph.edges) {
    neighbours.emplace(edge.frame_a, edge.frame_b);
    neighbours.emplace(edge.frame_b, edge.frame_a);
  }
  std::set<SensorId> tied = {graph.reference};
  std::vector<SensorId> open = {graph.reference};
  while (!open.empty()) {
    const auto [first, last] = neighbours.equal_range(open.back());
    open.pop_back();
    for (auto next = first; next != last; ++next)
      if (tied.insert(next->second).second) open.push_back(next->second);
  }
  return tied;
}

std::string ListedSensors(const std::vector<SensorId>& sensors) {
  constexpr std::size_t kNamesMax = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(sensors.size(), kNamesMax); ++i) text += (i == 0 ? "" : ", ") + sensors[i].str();
  return sensors.size() <= kNamesMax ? text : text + " and " + std::to_string(sensors.size() - kNamesMax) + " more";
}

// Whether a robot's graph stands without the sensor that was its reference: `before` and `after`, the graph with the
// sensor and without it, each with its own reference. kConflict, with what to do first, where no good edge is left, or
// a sensor that good edges tied to the old reference is not tied to the new one by any.
Status CheckNextReference(const Graph& before, const Graph& after) {
  const std::string gone = before.reference.str();
  const std::string what = "sensor " + gone + " is the reference that all others are told in, and ";
  if (after.edges.empty())
    return Fail(ErrorCode::kConflict, what + "no good edge ties any two of the others",
                "Push a session, or edges, that tie the others to each other; then retire " + gone + ".");
  const std::set<SensorId> tied = TiedToReference(after);
  std::vector<SensorId> lost;
  for (const SensorId& sensor : TiedToReference(before))
    if (sensor != before.reference && !tied.contains(sensor)) lost.push_back(sensor);
  if (lost.empty()) return {};
  const std::string others = ListedSensors(lost), next = after.reference.str();
  return Fail(
      ErrorCode::kConflict, what + "nothing else ties " + others + " to " + next,
      "Push a session, or edges, that tie " + others + " to " + next + " without it; then retire " + gone + ".");
}

// The transaction is given up where the robot cannot do without it.
Status RetireGone(storage::Store& store, const SensorOfRobot& of, const Word& word) {
  RIGCAL_ASSIGN(const RobotGraph before, LoadRobotGraph(store, of.robot));
  RIGCAL_TRY(storage::RetireSensor(store, of.robot, of.sensor, word));
  if (before.graph.reference != of.sensor) return {};
  RIGCAL_ASSIGN(const RobotGraph after, LoadRobotGraph(store, of.robot));
  return CheckNextReference(before.graph, after.graph);
}

Result<OrderDone> SayOf(storage::Store& store, const Saying& saying, const SensorOfRobot& of) {
  RIGCAL_TRY(saying.retires ? RetireGone(store, of, saying.word)
                            : storage::RestoreSensor(store, of.robot, of.sensor, saying.word));
  RIGCAL_ASSIGN(const auto standing, storage::LoadStanding(store, of.robot, of.sensor));
  RIGCAL_ASSIGN(const std::int64_t newest_edge, storage::LoadEdgeWatermark(store, of.robot));
  return OrderDone{of.robot, formats::WriteStandingOfSensor(of.robot, of.sensor, standing, newest_edge > 0)};
}

Result<std::string> WithVerified(const std::string& json, const std::string& name) {
  RIGCAL_ASSIGN(const auto parameters, formats::Parameters::Read(json));
  const std::string who = parameters.Text("who").value_or(name);
  if (who != name)
    return Fail(ErrorCode::kInvalidInput, "an order by '" + who + "' came with the identity of operator " + name,
                "Leave --by out: who gives an order is whose identity it comes with.");
  RIGCAL_TRY(CheckPerson(name));
  return formats::WithParameter(json, "who", name + kVerified);
}

bool IsDecision(const std::string& verb) { return verb == "approve" || verb == "reject" || verb == "rollback"; }

}  // namespace

bool IsOrder(const std::string& verb) {
  return verb == "restore" || verb == "retire" || verb == "set_policy" || verb == "set_rig_model" || verb == "epoch" ||
         verb == "measure_board" || verb == "resolve" || IsDecision(verb);
}

std::optional<Role> RoleOfOrder(const std::string& verb) {
  if (!IsOrder(verb)) return std::nullopt;
  if (verb == "set_policy" || verb == "set_rig_model") return Role::kAdmin;
  return IsDecision(verb) ? Role::kApprover : Role::kTechnician;
}

Result<OrderDone> CarryOut(storage::Store& store, const Clock& clock, const std::string& verb,
                           const std::string& json) {
  RIGCAL_ASSIGN(const Parameters parameters, Parameters::Read(json));
  if (verb == "set_policy") return SetPolicy(store, clock, parameters);
  if (verb == "set_rig_model") return SetRigModel(store, clock, parameters);
  if (verb == "epoch") return BeginEpochBy(store, clock, parameters);
  if (verb == "measure_board") return MeasureBoard(store, clock, parameters);
  if (verb == "resolve") return AskToRecompute(store, clock, parameters);
  if (IsDecision(verb)) return Decide(store, clock, verb, parameters);
  RIGCAL_ASSIGN(const Saying saying, SayingOf(clock, verb, parameters));
  OrderDone done;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(const Subject subject, FindSubject(store, parameters));
    RIGCAL_ASSIGN(done, std::visit([&](const auto& of) { return SayOf(store, saying, of); }, subject));
    return saying.retires ? FallBackByPolicy(store, done.robot, saying.word.at) : Status();
  }));
  return done;
}

Status CheckMayGive(const std::string& verb, const OrderOrigin& origin) {
  const auto needed = RoleOfOrder(verb);
  if (!origin.verified || !needed || MayActAs(origin.verified->role, *needed)) return {};
  Error error{
      ErrorCode::kInvalidInput,
      "the identity of " + origin.verified->name + ", " + NameOf(origin.verified->role) + ", does not let them " + verb,
      "Ask somebody whose identity has the role " + NameOf(*needed) + " (`rigcal identity new operator NAME --role " +
          NameOf(*needed) + "`)."};
  Log(LogLevel::kWarn, {.event = "refusal", .kind = NameOf(error.code)}, error.what);
  return Fail(std::move(error));
}

Result<std::string> WithChannel(storage::Store& store, const std::string& json, const OrderOrigin& origin) {
  if (origin.verified) return WithVerified(json, origin.verified->name);
  RIGCAL_ASSIGN(const bool has_users, storage::HasAccounts(store));
  if (origin.channel == OrderChannel::kHttp || !has_users) return json;
  RIGCAL_ASSIGN(const auto parameters, formats::Parameters::Read(json));
  const std::string who = parameters.Text("who").value_or("");
  if (who.find_first_not_of(' ') == std::string::npos) return json;  // it is refused, as without users
  RIGCAL_TRY(CheckPerson(who));
  return formats::WithParameter(json, "who", who + kNotVerified);
}

}  // namespace rigcal::pipeline
