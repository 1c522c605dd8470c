#include "server/pipeline/orders.h"

#include "server/base/text.h"
#include "server/formats/answers.h"
#include "server/formats/parameters.h"
#include "server/pipeline/current_edges.h"
#include "server/pipeline/policies.h"
#include "server/pipeline/robot_rows.h"
#include "storage/edges.h"
#include "storage/standing.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

Result<std::string> RequiredText(const Parameters& parameters, const std::string& name, const std::string& cure) {
  const auto text = parameters.Text(name);
  if (text && text->find_first_not_of(' ') != std::string::npos) return *text;
  return Fail(ErrorCode::kInvalidInput, "the parameter '" + name + "' is missing", cure);
}

Result<Word> WordOf(const Parameters& parameters, const Clock& clock) {
  RIGCAL_ASSIGN(std::string who, RequiredText(parameters, "who", "Say who asks for it."));
  return Word{clock.Now(), std::move(who), parameters.Text("reason").value_or("")};
}

Result<RobotId> RobotNamed(const Parameters& parameters) {
  const auto text = parameters.Text("robot");
  return text ? RobotId::Parse(*text) : RobotId();
}

// The one thing that `prefix` names.
template <typename AnId>
Result<AnId> OnlyOne(const std::vector<AnId>& ids, const std::string& kind, const std::string& prefix,
                     const RobotId& robot, const std::string& list) {
  const std::string of = robot.empty() ? "" : " of robot " + robot.str();
  if (ids.size() == 1) return ids.front();
  if (ids.empty())
    return Fail(ErrorCode::kNotFound, "no " + kind + of + " begins with " + Quoted(prefix),
                "`" + list + "` lists those that are known.");
  return Fail(ErrorCode::kConflict,
              std::to_string(ids.size()) + " " + kind + "s" + of + " begin with " + Quoted(prefix) + ": " +
                  ids[0].str() + ", " + ids[1].str() + (ids.size() > 2 ? ", ..." : ""),
              "Give more digits of its id.");
}

Result<OrderDone> Restore(storage::Store& store, const Clock& clock, const Parameters& parameters) {
  RIGCAL_ASSIGN(const Word word, WordOf(parameters, clock));
  RIGCAL_ASSIGN(const RobotId robot, RobotNamed(parameters));
  RIGCAL_ASSIGN(const std::string prefix, RequiredText(parameters, "session", "Name the session to restore."));
  formats::SessionAnswer row;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(const auto ids, storage::FindSessions(store, prefix, robot));
    RIGCAL_ASSIGN(const SessionId id, OnlyOne(ids, "session", prefix, robot, "rigcal sessions --json"));
    RIGCAL_TRY(storage::MakeCurrent(store, id, storage::MadeCurrent::kRestored, word));
    RIGCAL_ASSIGN(row, LoadSessionRow(store, id));
    return {};
  }));
  RIGCAL_ASSIGN(const std::int64_t newest_edge, storage::LoadEdgeWatermark(store, row.robot));
  return OrderDone{row.robot, formats::WriteRestored(row, newest_edge > 0)};
}

Result<OrderDone> RetireOne(storage::Store& store, const Clock& clock, const Parameters& parameters) {
  RIGCAL_ASSIGN(const Word word, WordOf(parameters, clock));
  RIGCAL_TRY(RequiredText(parameters, "reason", "Say why the edge is wrong."));
  RIGCAL_ASSIGN(const RobotId robot, RobotNamed(parameters));
  RIGCAL_ASSIGN(const std::string prefix, RequiredText(parameters, "edge", "Name the edge to retire."));
  std::optional<Edge> edge;
  Standing retired;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(const auto ids, storage::FindEdges(store, prefix, robot));
    RIGCAL_ASSIGN(const EdgeId id, OnlyOne(ids, "edge", prefix, robot, "rigcal edges ROBOT"));
    RIGCAL_ASSIGN(edge, storage::LoadEdge(store, id));
    if (!edge)
      return Fail(ErrorCode::kNotFound, "edge " + id.str() + " is of a batch that is not whole: it does not count",
                  "There is nothing to retire; push the batch again, then retire the edge.");
    RIGCAL_TRY(storage::RetireEdge(store, id, word));
    RIGCAL_ASSIGN(const auto all, storage::LoadRetired(store, edge->robot));
    retired = all.at(id);
    return {};
  }));
  Retire(retired.word, *edge);
  return OrderDone{edge->robot, formats::WriteRetired(*edge, retired)};
}

}  // namespace

bool IsOrder(const std::string& verb) { return verb == "restore" || verb == "retire" || verb == "set_policy"; }

Result<OrderDone> CarryOut(storage::Store& store, const Clock& clock, const std::string& verb,
                           const std::string& json) {
  RIGCAL_ASSIGN(const Parameters parameters, Parameters::Read(json));
  if (verb == "set_policy") return SetPolicy(store, clock, parameters);
  return verb == "retire" ? RetireOne(store, clock, parameters) : Restore(store, clock, parameters);
}

}  // namespace rigcal::pipeline
