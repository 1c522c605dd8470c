#include "server/pipeline/robots/asked.h"

#include <limits>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/model/approval/decision.h"
#include "server/pipeline/robots/unknown_names.h"
#include "server/pipeline/sessions/merged_members.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

constexpr const char* kListEdges = "`rigcal edges ROBOT` lists those that are known.";
constexpr const char* kListSessions = "`rigcal sessions --json` lists those that are known.";

std::string OfRobotText(const RobotId& robot) { return robot.empty() ? "" : " of robot " + robot.str(); }

template <typename AnId>
std::vector<Subject> SubjectsOf(const std::vector<AnId>& ids) {
  return {ids.begin(), ids.end()};
}

std::string IdOf(const Subject& subject) {
  if (const auto* edge = std::get_if<EdgeId>(&subject)) return edge->str();
  if (const auto* session = std::get_if<SessionId>(&subject)) return session->str();
  return std::get<SensorOfRobot>(subject).sensor.str();
}

// `kind`: "edge"; `prefix`: how its id begins.
Result<Subject> OnlyOne(const std::vector<Subject>& found, const std::string& kind, const std::string& prefix,
                        const RobotId& robot, const std::string& list) {
  if (found.size() == 1) return found.front();
  if (found.empty())
    return Fail(ErrorCode::kNotFound, "no " + kind + OfRobotText(robot) + " begins with " + Quoted(prefix), list);
  return Fail(ErrorCode::kConflict,
              std::to_string(found.size()) + " ids of " + kind + "s" + OfRobotText(robot) + " begin with " +
                  Quoted(prefix) + ": " + IdOf(found[0]) + ", " + IdOf(found[1]) + (found.size() > 2 ? ", ..." : ""),
              "Give more of its digits.");
}

Result<Subject> FindSensor(storage::Store& store, const std::string& name, const RobotId& robot) {
  if (robot.empty())
    return Fail(ErrorCode::kInvalidInput, Quoted(name) + " is no id of an edge or a session",
                "Give the id, or at least its first 8 digits (0-9, a-f); of a sensor, its robot too: --robot ROBOT.");
  RIGCAL_ASSIGN(const SensorId sensor, SensorId::Parse(name));
  RIGCAL_ASSIGN(const bool is_known_robot, storage::HasRobot(store, robot));
  if (!is_known_robot) return Fail(UnknownRobot(store, robot));
  RIGCAL_ASSIGN(const bool is_known, storage::HasSensor(store, robot, sensor));
  if (is_known) return Subject(SensorOfRobot{robot, sensor});
  RIGCAL_ASSIGN(const auto known, storage::LoadSensorsOf(store, robot));
  return Fail(UnknownSensor(robot, sensor, known));
}

Result<Subject> FindThing(storage::Store& store, const std::string& name, const RobotId& robot) {
  if (!robot.empty() && CheckName(SensorTag::kKind, name)) {
    RIGCAL_ASSIGN(const bool is_sensor, storage::HasSensor(store, robot, SensorId(name)));
    if (is_sensor) return Subject(SensorOfRobot{robot, SensorId(name)});
  }
  const auto edges = storage::FindEdges(store, name, robot);
  if (!edges)
    return edges.error().code == ErrorCode::kInvalidInput ? FindSensor(store, name, robot) : Fail(edges.error());
  RIGCAL_ASSIGN(const auto sessions, storage::FindSessions(store, name, robot));
  if (edges->empty() && sessions.empty()) RIGCAL_TRY(CheckIsNotMerged(store, name, robot));
  std::vector<Subject> found = SubjectsOf(*edges);
  found.insert(found.end(), sessions.begin(), sessions.end());
  const bool one_kind = edges->empty() != sessions.empty();
  return OnlyOne(found, one_kind ? (edges->empty() ? "session" : "edge") : "edge or session", name, robot,
                 "`rigcal edges ROBOT` and `rigcal sessions` list those that are known.");
}

}  // namespace

Result<formats::Parameters> ParametersAsked(const std::string& query) {
  RIGCAL_ASSIGN(const std::string json, formats::ParametersOfQuery(query));
  return formats::Parameters::Read(json);
}

Result<RobotId> KnownRobot(storage::Store& store, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, RequiredId<RobotId>(parameters, "robot"));
  RIGCAL_ASSIGN(const bool is_known, storage::HasRobot(store, robot));
  if (is_known) return robot;
  return Fail(UnknownRobot(store, robot));
}

Result<std::int64_t> PageRows(const formats::Parameters& parameters) {
  if (!parameters.Text("limit")) return parameters.Text("before") ? limits::kPageRowsMax : 0;
  RIGCAL_ASSIGN(const std::int64_t limit, parameters.IntegerOr("limit", 0));
  if (limit >= 1 && limit <= limits::kPageRowsMax) return limit;
  return Fail(ErrorCode::kInvalidInput, "the parameter 'limit' is " + std::to_string(limit),
              "Ask for 1 to " + std::to_string(limits::kPageRowsMax) + " rows at once.");
}

Result<int> RevisionBefore(const formats::Parameters& parameters) {
  if (!parameters.Text("before")) return 0;
  RIGCAL_ASSIGN(const std::int64_t before, parameters.IntegerOr("before", 0));
  if (before >= 1 && before <= std::numeric_limits<int>::max()) return static_cast<int>(before);
  return Fail(ErrorCode::kInvalidInput, "the parameter 'before' is " + std::to_string(before),
              "Give the number of a revision.");
}

Result<std::string> RequiredText(const Parameters& parameters, const std::string& name, const std::string& cure) {
  const auto text = parameters.Text(name);
  if (text && text->find_first_not_of(' ') != std::string::npos) return *text;
  return Fail(ErrorCode::kInvalidInput, "the parameter '" + name + "' is missing", cure);
}

Result<std::string> RequiredWho(const Parameters& parameters, const std::string& cure) {
  RIGCAL_ASSIGN(std::string who, RequiredText(parameters, "who", cure));
  RIGCAL_TRY(CheckPerson(who));
  return who;
}

Result<Word> RequiredWord(const Parameters& parameters, Stamp now, const std::string& who_cure,
                          const std::string& reason_cure) {
  Word word{now, "", ""};
  RIGCAL_ASSIGN(word.who, RequiredWho(parameters, who_cure));
  RIGCAL_ASSIGN(word.reason, RequiredText(parameters, "reason", reason_cure));
  return word;
}

Result<Subject> FindSubject(storage::Store& store, const Parameters& parameters) {
  const auto of_robot = parameters.Text("robot");
  RIGCAL_ASSIGN(const RobotId robot, of_robot ? RobotId::Parse(*of_robot) : RobotId());
  if (const auto prefix = parameters.Text("edge")) {
    RIGCAL_ASSIGN(const auto ids, storage::FindEdges(store, *prefix, robot));
    if (ids.empty()) RIGCAL_TRY(CheckIsNotMerged(store, *prefix, robot));
    return OnlyOne(SubjectsOf(ids), "edge", *prefix, robot, kListEdges);
  }
  if (const auto prefix = parameters.Text("session")) {
    RIGCAL_ASSIGN(const auto ids, storage::FindSessions(store, *prefix, robot));
    return OnlyOne(SubjectsOf(ids), "session", *prefix, robot, kListSessions);
  }
  if (const auto name = parameters.Text("sensor")) return FindSensor(store, *name, robot);
  RIGCAL_ASSIGN(const std::string thing, RequiredText(parameters, "thing", "Name an edge, a session or a sensor."));
  return FindThing(store, thing, robot);
}

}  // namespace rigcal::pipeline
