#include "server/pipeline/answers/lists.h"

#include <unordered_map>

#include "server/formats/answers/answers.h"
#include "server/model/edges/past.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/sessions/current_edges.h"
#include "storage/edges/edges.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/epochs.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

// One more than the page holds tells whether another follows.
std::int64_t RowsToLoad(std::int64_t page_rows) { return page_rows == 0 ? storage::kAllRows : page_rows + 1; }

// Absent of a list in one piece, empty on the last page.
template <typename Row, typename IdOfRow>
formats::NextPage NextOf(std::int64_t page_rows, std::vector<Row>& rows, const IdOfRow& id_of) {
  if (page_rows == 0) return std::nullopt;
  return CutToPage(page_rows, rows) ? id_of(rows.back()).str() : std::string();
}

// An edge whose file was lost is past once another took its place: that one may be on another page.
Status AddRepeats(storage::Store& store, std::vector<Edge>& edges) {
  std::vector<EdgeId> repeats;
  for (const Edge& edge : edges)
    if (FailedForLostFile(edge)) repeats.push_back(RepeatedEdgeId(edge.id));
  if (repeats.empty()) return {};
  RIGCAL_ASSIGN(auto again, storage::LoadEdges(store, repeats, false));
  std::move(again.begin(), again.end(), std::back_inserter(edges));
  return {};
}

// As they stand now, in the order of `ids`.
Result<std::vector<Edge>> LoadInOrder(storage::Store& store, const RobotId& robot, const std::vector<EdgeId>& ids) {
  RIGCAL_ASSIGN(auto edges, storage::LoadEdges(store, ids, false));
  RIGCAL_TRY(AddRepeats(store, edges));
  RIGCAL_ASSIGN(const auto counts, storage::LoadWhatCounts(store, robot));
  RIGCAL_TRY(MarkPast(store, counts, edges));
  std::unordered_map<EdgeId, Edge*> by_id;
  for (Edge& edge : edges) by_id.emplace(edge.id, &edge);
  std::vector<Edge> in_order;
  for (const EdgeId& id : ids)
    if (const auto found = by_id.find(id); found != by_id.end()) in_order.push_back(std::move(*found->second));
  return in_order;
}

Result<std::vector<Edge>> LoadAll(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(auto edges, storage::LoadEdges(store, robot, false));
  RIGCAL_ASSIGN(const auto counts, storage::LoadWhatCounts(store, robot));
  RIGCAL_TRY(MarkPast(store, counts, edges));
  return edges;
}

// Of one moment.
Result<std::vector<Epoch>> LoadEpochsTogether(storage::Store& store, const RobotId& robot) {
  std::vector<Epoch> epochs;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(epochs, storage::LoadEpochs(store, robot));
    return {};
  }));
  return epochs;
}

}  // namespace

Result<std::string> ListSessions(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, OptionalId<RobotId>(parameters, "robot"));
  if (!robot.empty()) RIGCAL_TRY(KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const std::int64_t page_rows, PageRows(parameters));
  RIGCAL_ASSIGN(const SessionId before, OptionalId<SessionId>(parameters, "before"));
  RIGCAL_ASSIGN(auto rows, LoadSessionRows(context.store, robot, before, RowsToLoad(page_rows)));
  const formats::NextPage next = NextOf(page_rows, rows, [](const formats::SessionAnswer& row) { return row.session; });
  RIGCAL_TRY(AddStanding(context.store, robot, rows));
  return formats::WriteSessions(rows, next);
}

Result<std::string> ListEdges(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const std::int64_t page_rows, PageRows(parameters));
  RIGCAL_ASSIGN(const EdgeId before, OptionalId<EdgeId>(parameters, "before"));
  std::vector<Edge> edges;
  formats::NextPage next;
  if (page_rows == 0) {
    RIGCAL_ASSIGN(edges, LoadAll(context.store, robot));
  } else {
    RIGCAL_ASSIGN(auto ids, storage::LoadEdgeIds(context.store, robot, before, RowsToLoad(page_rows)));
    next = NextOf(page_rows, ids, [](const EdgeId& id) { return id; });
    RIGCAL_ASSIGN(edges, LoadInOrder(context.store, robot, ids));
  }
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(context.store, robot, 0));
  if (!newest) return formats::WriteEdges(robot, 0, edges, {}, next);
  RIGCAL_ASSIGN(const ParsedRevision revision, context.revisions.Load(context.store, robot, newest->number));
  return formats::WriteEdges(robot, newest->number, edges, revision.document->solution.residuals, next);
}

Result<std::string> ListRevisions(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const std::int64_t page_rows, PageRows(parameters));
  RIGCAL_ASSIGN(const int before, RevisionBefore(parameters));
  RIGCAL_ASSIGN(auto revisions, storage::LoadRevisions(context.store, robot, before, RowsToLoad(page_rows)));
  std::optional<int> next;
  if (page_rows > 0) next = CutToPage(page_rows, revisions) ? revisions.back().number : 0;
  std::vector<int> numbers;
  for (const Revision& revision : revisions) numbers.push_back(revision.number);
  RIGCAL_ASSIGN(const auto as_found, storage::LoadAsFoundSummaries(context.store, robot, numbers));
  RIGCAL_ASSIGN(const auto approvals, LoadApprovals(context.store, robot, revisions));
  std::vector<Epoch> epochs;
  if (before == 0) {
    RIGCAL_ASSIGN(epochs, LoadEpochsTogether(context.store, robot));
  }
  return formats::WriteRevisions(robot, revisions, context.clock.Now(), next, approvals, as_found, epochs);
}

}  // namespace rigcal::pipeline
