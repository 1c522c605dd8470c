#include "server/pipeline/pages/robot_pages.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <memory>
#include <set>

#include "server/formats/answers/parameters.h"
#include "server/model/edges/past.h"
#include "server/pipeline/answers/certificate.h"
#include "server/pipeline/boards/registry.h"
#include "server/pipeline/edges/unreadable.h"
#include "server/pipeline/pages/compared_lenses.h"
#include "server/pipeline/pages/trend_data.h"
#include "server/pipeline/revisions/whole_revision.h"
#include "server/pipeline/rig_models/rig_models.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/summaries.h"
#include "server/pipeline/sessions/current_edges.h"
#include "server/report/pages/certificate.h"
#include "server/report/robot_pages.h"
#include "storage/edges/edges.h"
#include "storage/files/blobs.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/sessions.h"
#include "storage/settings/policies.h"

namespace rigcal::pipeline {
namespace {

constexpr const char* kHtmlType = "text/html; charset=utf-8";
constexpr std::int64_t kListRows = 50;  // of revisions, and of sessions
constexpr std::size_t kTrendSensorsMax = 60;
constexpr std::size_t kPictureBytesMax = 64u << 20;

tl::unexpected<Error> NoPage(const std::string& rest) {
  return Fail(ErrorCode::kNotFound, "there is no page /robots/" + rest, "Start at the list of robots.");
}

report::SessionRow SessionRowOf(const formats::SessionAnswer& answer) {
  report::SessionRow row;
  row.id = answer.session;
  row.captured_at = answer.captured_at.value_or(Stamp{});
  row.operator_name = answer.operator_name;
  row.closed = answer.closed;
  row.files = answer.payloads;
  row.files_held = answer.payloads_held;
  row.pairs = answer.jobs_total;
  row.pairs_waiting = answer.jobs_waiting;
  row.superseded_by = answer.superseded_by;
  if (answer.retired) row.retired = answer.retired->word;
  return row;
}

Status AddResults(const AnswerContext& context, std::vector<report::SessionRow>& rows) {
  std::vector<SessionId> sessions;
  for (const report::SessionRow& row : rows) sessions.push_back(row.id);
  RIGCAL_ASSIGN(const auto facts, storage::LoadSessionFacts(context.store, sessions));
  for (report::SessionRow& row : rows) {
    const auto found = facts.find(row.id);
    if (found != facts.end()) row.good = found->second.good, row.failed = found->second.failed;
  }
  return {};
}

Result<std::map<SessionId, Stamp>> CapturedAt(const AnswerContext& context, const report::CompareInput& compared) {
  std::set<SessionId> sessions;
  for (const report::SolvedRevision* one : {&compared.before, &compared.now})
    for (const Edge& edge : one->revision->edges)
      if (!edge.session.empty()) sessions.insert(edge.session);
  return storage::LoadCapturedAt(context.store, {sessions.begin(), sessions.end()});
}

// Of the newest revision; none if there are more than charts would show.
Result<std::vector<SensorId>> TrendSensors(const AnswerContext& context, const RobotId& robot, int newest_revision) {
  std::vector<SensorId> sensors;
  if (newest_revision < 2) return sensors;
  RIGCAL_ASSIGN(const ParsedRevision newest, context.revisions.Load(context.store, robot, 0));
  for (const SensorPose& pose : newest.document->solution.poses)
    if (pose.known && pose.sensor != newest.document->reference) sensors.push_back(pose.sensor);
  if (sensors.size() > kTrendSensorsMax) sensors.clear();
  return sensors;
}

// What a person took out says no more why it failed.
bool IsTakenOut(const Diagnosis& why) { return why.code == kRetiredCode || why.code == kSensorRetiredCode; }

// Of edges as they were measured: which do not count now, and why. Of those that failed only what was retired.
Result<std::map<EdgeId, Diagnosis>> WhyPast(const AnswerContext& context, const RobotId& robot,
                                            const std::vector<Edge>& edges) {
  RIGCAL_ASSIGN(const auto counts, storage::LoadWhatCounts(context.store, robot));
  std::vector<Edge> now = edges;
  RIGCAL_TRY(MarkPast(context.store, counts, now));
  std::map<EdgeId, Diagnosis> past;
  for (std::size_t i = 0; i < now.size(); ++i)
    if (IsPast(now[i]) && (edges[i].state == EdgeState::kGood || IsTakenOut(now[i].diagnoses.front())))
      past.emplace(now[i].id, now[i].diagnoses.front());
  return past;
}

// The list of sessions counts as good what still counts, as the session's own page.
Status MovePast(const AnswerContext& context, const RobotId& robot, std::vector<report::SessionRow>& rows) {
  std::vector<SessionId> sessions;
  for (const report::SessionRow& row : rows) sessions.push_back(row.id);
  RIGCAL_ASSIGN(auto edges, storage::LoadEdgeRows(context.store, sessions));
  std::erase_if(edges, [](const Edge& edge) { return edge.state != EdgeState::kGood; });
  RIGCAL_ASSIGN(const auto past, WhyPast(context, robot, edges));
  std::map<SessionId, std::int64_t> counts;
  for (const Edge& edge : edges)
    if (past.contains(edge.id)) ++counts[edge.session];
  for (report::SessionRow& row : rows) {
    const auto found = counts.find(row.id);
    if (found == counts.end() || row.superseded_by) continue;
    row.past = std::min(found->second, row.good);
    row.good -= row.past;
  }
  return {};
}

std::vector<report::SessionRow> SessionRowsOf(const std::vector<formats::SessionAnswer>& answers) {
  std::vector<report::SessionRow> rows;
  for (const formats::SessionAnswer& answer : answers) rows.push_back(SessionRowOf(answer));
  return rows;
}

Status TakeListedRevisions(const AnswerContext& context, const RobotId& robot, int before, report::RobotInput& input) {
  RIGCAL_ASSIGN(input.revisions, storage::LoadRevisions(context.store, robot, before, kListRows + 1));
  input.older_revisions = CutToPage(kListRows, input.revisions);
  input.newest_revisions = before == 0;
  RIGCAL_ASSIGN(const auto approvals, LoadApprovals(context.store, robot, input.revisions));
  for (std::size_t i = 0; i < approvals.size(); ++i) input.states[input.revisions[i].number] = approvals[i].state;
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(context.store, robot, 0));
  if (!newest) return {};
  RIGCAL_ASSIGN(input.approval, LoadApproval(context.store, *newest));
  return {};
}

Status TakeListedSessions(const AnswerContext& context, const RobotId& robot, const SessionId& before,
                          report::RobotInput& input) {
  RIGCAL_ASSIGN(auto sessions, LoadSessionRows(context.store, robot, before, kListRows + 1));
  input.older_sessions = CutToPage(kListRows, sessions);
  input.newest_sessions = before.empty();
  RIGCAL_TRY(AddStanding(context.store, robot, sessions));
  input.sessions = SessionRowsOf(sessions);
  RIGCAL_TRY(AddResults(context, input.sessions));
  RIGCAL_TRY(MovePast(context, robot, input.sessions));
  RIGCAL_ASSIGN(const auto open, LoadOpenSessionRows(context.store, robot));
  input.open = SessionRowsOf(open);
  return {};
}

Result<PageText> RobotPage(const AnswerContext& context, const RobotId& robot, const std::string& query) {
  RIGCAL_ASSIGN(const auto parameters, ParametersAsked(query));
  RIGCAL_ASSIGN(const int revisions_before, RevisionBefore(parameters));
  RIGCAL_ASSIGN(const SessionId sessions_before, OptionalId<SessionId>(parameters, "sessions_before"));
  const Stamp now = context.clock.Now();
  report::RobotInput input;
  RIGCAL_ASSIGN(input.row, LoadRobotSummary(context.store, robot, now));
  RIGCAL_TRY(TakeListedRevisions(context, robot, revisions_before, input));
  RIGCAL_TRY(TakeListedSessions(context, robot, sessions_before, input));
  RIGCAL_ASSIGN(const auto gone, storage::LoadRetiredSensors(context.store, robot));
  for (const auto& [sensor, standing] : gone) input.retired.push_back({sensor, standing.word});
  RIGCAL_TRY(context.store.Read([&]() -> Status {
    RIGCAL_ASSIGN(input.epochs, storage::LoadEpochs(context.store, robot));
    RIGCAL_ASSIGN(input.rig_model, storage::LoadRigModel(context.store, robot));
    return {};
  }));
  RIGCAL_ASSIGN(input.sensors, TrendSensors(context, robot, input.row.revision));
  RIGCAL_ASSIGN(std::string body, report::RenderRobot(input, now));
  return PageText{std::move(body), kHtmlType};
}

// What tells of its cameras: figures and evidence of its edges.
Result<report::SolvedRevision> WithCameras(const AnswerContext& context, const ParsedRevision& parsed) {
  if (parsed.document->whole) return report::SolvedRevision{parsed.summary.number, parsed.document};
  RIGCAL_ASSIGN(auto whole, WithWholeEdges(context.store, parsed.summary.number, *parsed.document, Blocks::kLeftOut));
  return report::SolvedRevision{parsed.summary.number,
                                std::make_shared<const formats::RevisionInput>(std::move(whole))};
}

Result<PageText> ComparePage(const AnswerContext& context, const RobotId& robot, const std::string& query) {
  RIGCAL_ASSIGN(const auto parameters, ParametersAsked(query));
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(context.store, robot, 0));
  report::CompareInput input;
  input.robot = robot;
  input.newest = newest ? newest->number : 0;
  RIGCAL_ASSIGN(const std::int64_t now, parameters.IntegerOr("a", input.newest));
  RIGCAL_ASSIGN(const std::int64_t before, parameters.IntegerOr("b", std::max(input.newest - 1, 1)));
  RIGCAL_ASSIGN(const ParsedRevision first, context.revisions.Load(context.store, robot, std::min(before, now)));
  RIGCAL_ASSIGN(const ParsedRevision second, context.revisions.Load(context.store, robot, std::max(before, now)));
  RIGCAL_ASSIGN(input.before, WithCameras(context, first));
  RIGCAL_ASSIGN(input.now, WithCameras(context, second));
  RIGCAL_ASSIGN(input.captured_at, CapturedAt(context, input));
  input.lenses = CompareLenses(context.store, input.before, input.now, input.captured_at);
  RIGCAL_ASSIGN(std::string body, report::RenderCompare(input));
  return PageText{std::move(body), kHtmlType};
}

Result<formats::SessionAnswer> SessionOf(const AnswerContext& context, const RobotId& robot, const std::string& name) {
  RIGCAL_ASSIGN(const SessionId id, SessionId::Parse(name));
  RIGCAL_ASSIGN(auto row, LoadSessionRow(context.store, id));
  if (row.robot == robot) return row;
  return Fail(ErrorCode::kNotFound, "session " + name + " is of another robot", "See /robots/" + row.robot.str() + "/");
}

Result<PageText> SessionPage(const AnswerContext& context, const RobotId& robot, const std::string& name) {
  RIGCAL_ASSIGN(const auto row, SessionOf(context, robot, name));
  report::SessionInput input;
  input.robot = robot;
  std::vector<report::SessionRow> rows = {SessionRowOf(row)};
  RIGCAL_TRY(AddResults(context, rows));
  input.row = rows.front();
  RIGCAL_ASSIGN(auto manifest, storage::LoadManifest(context.store, row.session));
  if (manifest) input.manifest = std::move(*manifest);
  RIGCAL_ASSIGN(input.retired, LoadRetiredSensorsIn(context.store, robot, input.manifest));
  RIGCAL_ASSIGN(input.lacking, LoadLacking(context.store, robot, input.manifest.header));
  RIGCAL_ASSIGN(input.board_remarks, LoadBoardRemarks(context.store, {row.session}));
  RIGCAL_ASSIGN(input.edges, storage::LoadEdges(context.store, row.session));
  RIGCAL_ASSIGN(input.past, WhyPast(context, robot, input.edges));
  RIGCAL_ASSIGN(input.robot_now, LoadRobotSummary(context.store, robot, context.clock.Now()));
  if (input.row.closed && input.row.pairs_waiting == 0) {
    Unreadable unreadable = FindUnreadable(context.store, input.manifest, input.edges);
    input.unreadable = std::move(unreadable.why);
    input.all_looked_at = unreadable.all_looked_at;
  }
  RIGCAL_ASSIGN(std::string body, report::RenderSession(input));
  return PageText{std::move(body), kHtmlType};
}

// Only pictures that an edge of this session names: the blobs of others are not handed out.
Result<PageText> SessionPicture(const AnswerContext& context, const RobotId& robot, const std::string& name,
                                const std::string& file) {
  RIGCAL_ASSIGN(const auto row, SessionOf(context, robot, name));
  RIGCAL_ASSIGN(const auto edges, storage::LoadEdges(context.store, row.session));
  for (const Edge& edge : edges)
    for (const Evidence& evidence : edge.evidence) {
      if (evidence.suffix == "fit" || evidence.digest.str() + "." + evidence.suffix != file) continue;
      RIGCAL_ASSIGN(std::string bytes, storage::LoadBlob(context.store.blobs(), evidence.digest, kPictureBytesMax));
      return PageText{std::move(bytes), evidence.suffix == "png" ? "image/png" : "image/jpeg", true};
    }
  return Fail(ErrorCode::kNotFound, "session " + name + " has no picture " + file, "Open the session's page.");
}

// What is there is served without asking here; but the certificate, which has to know what was decided since.
Result<PageText> RevisionFile(const AnswerContext& context, const RobotId& robot,
                              const std::vector<std::string>& parts) {
  int number = 0;
  const std::string& text = parts[2];
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 1)
    return Fail(ErrorCode::kNotFound, "there is no revision " + text, "Start at the list of robots.");
  std::string file = parts[3];
  for (std::size_t i = 4; i < parts.size(); ++i) file += "/" + parts[i];
  if (file != report::kCertificateFile)
    return Fail(WhyMissing(context, robot, number, file.empty() ? "index.html" : file));
  RIGCAL_ASSIGN(std::string body, CertificatePage(context, robot, number));
  return PageText{std::move(body), kHtmlType};
}

}  // namespace

Result<PageText> AnswerRobotPage(const AnswerContext& context, const std::string& rest, const std::string& query) {
  std::vector<std::string> parts;  // the last is empty for an address that ends in '/'
  for (std::size_t start = 0; start <= rest.size();) {
    const std::size_t end = std::min(rest.find('/', start), rest.size());
    parts.push_back(rest.substr(start, end - start));
    start = end + 1;
  }
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(parts[0]));
  if (parts.size() == 2 && parts[1].empty()) return RobotPage(context, robot, query);
  if (parts.size() == 2 && parts[1] == "trend.js") return AnswerTrend(context, robot);
  if (parts.size() == 2 && parts[1] == "compare") return ComparePage(context, robot, query);
  if (parts.size() >= 4 && parts[1] == "revisions") return RevisionFile(context, robot, parts);
  if (parts.size() < 4 || parts[1] != "sessions") return NoPage(rest);
  if (parts.size() == 4 && parts[3].empty()) return SessionPage(context, robot, parts[2]);
  if (parts.size() == 5 && parts[3] == "evidence") return SessionPicture(context, robot, parts[2], parts[4]);
  return NoPage(rest);
}

}  // namespace rigcal::pipeline
