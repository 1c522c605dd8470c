#include "server/pipeline/answers/lists.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "server/base/text.h"
#include "server/formats/alerts/calendar.h"
#include "server/formats/alerts/webhook_answers.h"
#include "server/formats/answers/answers.h"
#include "server/formats/sites/forward.h"
#include "server/model/edges/past.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/summaries.h"
#include "server/pipeline/robots/unknown_names.h"
#include "server/pipeline/sessions/current_edges.h"
#include "server/pipeline/sessions/merged_members.h"
#include "storage/alerts/outbox.h"
#include "storage/audit.h"
#include "storage/edges/edges.h"
#include "storage/fleet/fleet_list.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/epochs.h"
#include "storage/sites/forward_queue.h"

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

// 0 where it is not there.
Result<std::int64_t> AuditRowBefore(const Parameters& parameters) {
  if (!parameters.Text("before")) return 0;
  RIGCAL_ASSIGN(const std::int64_t before, parameters.IntegerOr("before", 0));
  if (before >= 1) return before;
  return Fail(ErrorCode::kInvalidInput, "the parameter 'before' is " + std::to_string(before),
              "Give the number of an audit row.");
}

std::string DescriptionOf(const RobotSummary& robot, const std::string& http_address, Stamp now) {
  const CalibrationStatus status = StatusAt(robot, now);
  std::string text = DueText(robot.validity, robot.drift_due) + "\n" + NameOf(status.word) + ": " + status.why + "\n" +
                     status.next_step;
  if (!http_address.empty()) text += "\n" + http_address + "/robots/" + robot.robot.str() + "/";
  return text;
}

// It was found out when its calibration was measured: the same data are the same entry, whenever it is asked for.
formats::CalendarEntry EntryOf(const RobotSummary& robot, Stamp due, const std::string& http_address) {
  const bool by_drift = robot.drift_due && robot.drift_due->at == due;
  formats::CalendarEntry entry;
  entry.uid = robot.robot.str() + ".calibration@rigcal";
  entry.day = due;
  entry.known_at = *robot.validity.calibrated_at;
  entry.sequence = robot.revision;
  entry.summary =
      "Calibrate " + robot.robot.str() + (by_drift ? " (drift of " + robot.drift_due->sensor.str() + ")" : "");
  entry.description = DescriptionOf(robot, http_address, due);
  entry.location = robot.site;
  return entry;
}

Result<std::vector<ReceiverState>> LoadStates(storage::Store& store) {
  std::vector<ReceiverState> states;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(states, storage::LoadReceivers(store));
    return {};
  }));
  return states;
}

// Addresses that differ in what is not shown are one, as no two samples may have one name.
void AddPerReceiver(const std::string& name, const std::string& help, const std::vector<ReceiverState>& states,
                    std::int64_t ReceiverState::*count, std::vector<metrics::Reading>& readings) {
  std::map<std::string, std::int64_t> by_url;
  for (const ReceiverState& one : states) by_url[one.url] += one.*count;
  for (const auto& [url, sum] : by_url) readings.push_back({name, help, static_cast<double>(sum), {{"url", url}}});
}

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

// Behind the one before; all where there is none.
Status LeaveOutNewer(const EdgeId& before, std::vector<Edge>& newest_first) {
  if (before.empty()) return {};
  const auto found =
      std::find_if(newest_first.begin(), newest_first.end(), [&](const Edge& edge) { return edge.id == before; });
  if (found == newest_first.end())
    return Fail(ErrorCode::kNotFound, "edge " + before.str() + " is not in that merged edge",
                "Give the id of the last one of the page before.");
  newest_first.erase(newest_first.begin(), found + 1);
  return {};
}

// Residuals of these the revision does not know. Whole: the oldest first; by pages, the newest first as every list.
Result<std::string> ListEdgesWithin(const AnswerContext& context, const RobotId& robot, const std::string& merged,
                                    const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::int64_t page_rows, PageRows(parameters));
  RIGCAL_ASSIGN(const EdgeId before, OptionalId<EdgeId>(parameters, "before"));
  RIGCAL_ASSIGN(const FoundMerged found, OnlyMerged(context.store, merged, robot));
  RIGCAL_ASSIGN(auto edges, LoadWithin(context.store, found));
  formats::NextPage next;
  if (page_rows > 0) {
    std::reverse(edges.begin(), edges.end());
    RIGCAL_TRY(LeaveOutNewer(before, edges));
    next = NextOf(page_rows, edges, [](const Edge& edge) { return edge.id; });
  }
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(context.store, robot, 0));
  return formats::WriteEdges(robot, newest ? newest->number : 0, edges, {}, next);
}

Result<std::string> ListEdges(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  if (const auto in = parameters.Text("in")) return ListEdgesWithin(context, robot, *in, parameters);
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

Result<std::string> ListAudit(const AnswerContext& context, const Parameters& parameters) {
  RobotId robot;
  if (parameters.Text("robot")) {
    RIGCAL_ASSIGN(robot, KnownRobot(context.store, parameters));
  }
  RIGCAL_ASSIGN(const std::int64_t page_rows, PageRows(parameters));
  RIGCAL_ASSIGN(const std::int64_t before, AuditRowBefore(parameters));
  RIGCAL_ASSIGN(auto rows, storage::LoadAudit(context.store, robot, before, RowsToLoad(page_rows)));
  std::optional<std::int64_t> next;
  if (page_rows > 0) next = CutToPage(page_rows, rows) ? rows.back().number : 0;
  return formats::WriteAudit(rows, next);
}

Result<std::string> VerifyAudit(const AnswerContext& context, const Parameters&) {
  RIGCAL_ASSIGN(const AuditCheck check, storage::VerifyAudit(context.store));
  return formats::WriteAuditCheck(check);
}

Result<std::string> TellDueCalendar(const AnswerContext& context, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const DueCalendar calendar, MakeDueCalendar(context, parameters));
  return formats::WriteDueCalendar(calendar.text, calendar.without_date);
}

Result<std::string> ListWebhooks(const AnswerContext& context, const formats::Parameters&) {
  RIGCAL_ASSIGN(const auto states, LoadStates(context.store));
  return formats::WriteWebhooks(states, context.clock.Now());
}

Result<std::string> TellCentre(const AnswerContext& context, const formats::Parameters&) {
  RIGCAL_ASSIGN(const auto state, storage::LoadForwardState(context.store));
  return formats::WriteForwardState(state);
}

}  // namespace

Result<DueCalendar> MakeDueCalendar(const AnswerContext& context, const formats::Parameters& parameters) {
  FleetQuery asked;
  asked.sort = "robot";
  asked.site = parameters.Text("site").value_or("");
  static_cast<void>(FreshenSummaries(context.store, context.clock));  // what could not be kept is there soon
  DueCalendar calendar;
  std::vector<formats::CalendarEntry> entries;
  const auto add = [&](const RobotSummary& robot) {
    const std::optional<Stamp> due = DueAt(robot.validity, robot.drift_due);
    due ? entries.push_back(EntryOf(robot, *due, context.http_address)) : void(++calendar.without_date);
  };
  RIGCAL_TRY(context.store.Read([&] { return storage::ForEachRobot(context.store, asked, context.clock.Now(), add); }));
  // An empty calendar would say for ever that nothing is due there.
  if (!asked.site.empty() && entries.empty() && calendar.without_date == 0)
    return Fail(UnknownSite(context.store, asked.site));
  const std::string name = asked.site.empty() ? "Calibrations due" : "Calibrations due: " + asked.site;
  calendar.text = formats::WriteCalendar(name, entries);
  return calendar;
}

Result<std::vector<metrics::Reading>> AlertReadings(storage::Store& store, const FleetCounts& fleet) {
  RIGCAL_ASSIGN(const auto states, LoadStates(store));
  std::vector<metrics::Reading> readings;
  for (const auto& [word, robots] : fleet.statuses)
    readings.push_back(
        {"rigcal_robots_by_status", "Robots by status", static_cast<double>(robots), {{"status", NameOf(word)}}});
  AddPerReceiver("rigcal_webhook_waiting", "Alerts that wait for this receiver", states, &ReceiverState::waiting,
                 readings);
  AddPerReceiver("rigcal_webhook_delivered_total", "Alerts that this receiver took", states, &ReceiverState::delivered,
                 readings);
  return readings;
}

std::vector<VerbAnswer> ListVerbs() {
  return {{"sessions", ListSessions}, {"edges", ListEdges},          {"revisions", ListRevisions},
          {"audit", ListAudit},       {"audit_verify", VerifyAudit}, {"due_ics", TellDueCalendar},
          {"webhooks", ListWebhooks}, {"centre", TellCentre}};
}

}  // namespace rigcal::pipeline
