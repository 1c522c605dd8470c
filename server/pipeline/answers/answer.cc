#include "server/pipeline/answers/answer.h"

#include <algorithm>
#include <functional>
#include <map>

#include "server/base/version.h"
#include "server/formats/answers/answers.h"
#include "server/formats/answers/parameters.h"
#include "server/graph/fusion/merged_edge.h"
#include "server/pipeline/answers/certificate.h"
#include "server/pipeline/answers/lists.h"
#include "server/pipeline/answers/live.h"
#include "server/pipeline/answers/lookup.h"
#include "server/pipeline/answers/names.h"
#include "server/pipeline/answers/sensor_facts.h"
#include "server/pipeline/boards/registry.h"
#include "server/pipeline/recomputation/ask.h"
#include "server/pipeline/reports/report_files.h"
#include "server/pipeline/revisions/whole_revision.h"
#include "server/pipeline/rig_models/population.h"
#include "server/pipeline/rig_models/rig_models.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/policies.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/summaries.h"
#include "server/pipeline/robots/unknown_names.h"
#include "server/pipeline/robots/validity.h"
#include "server/pipeline/sessions/merged_members.h"
#include "storage/edges/edges.h"
#include "storage/files/lost_blobs.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;
using Verb = std::function<Result<std::string>(const AnswerContext&, const Parameters&)>;

Result<std::string> Robots(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotList list, LoadRobotList(context.store, context.clock, parameters));
  return formats::WriteRobots(list.robots, context.clock.Now(), list.next);
}

Result<std::string> Session(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const SessionId id, RequiredId<SessionId>(parameters, "id"));
  RIGCAL_ASSIGN(const auto row, LoadSessionRow(context.store, id));
  RIGCAL_ASSIGN(auto stored, storage::LoadManifest(context.store, id));
  const Manifest manifest = std::move(stored).value_or(Manifest{});
  RIGCAL_ASSIGN(const auto edges, storage::LoadEdges(context.store, id));
  RIGCAL_ASSIGN(const auto retired, LoadRetiredSensorsIn(context.store, row.robot, manifest));
  RIGCAL_ASSIGN(const std::string lacking, LoadLacking(context.store, row.robot, manifest.header));
  RIGCAL_ASSIGN(const auto remarks, LoadBoardRemarks(context.store, {id}));
  return formats::WriteSession(row, manifest, edges, retired, lacking, remarks);
}

Result<std::string> OneEdge(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const EdgeId id, RequiredId<EdgeId>(parameters, "id"));
  RIGCAL_ASSIGN(const RobotId robot, OptionalId<RobotId>(parameters, "robot"));
  RIGCAL_ASSIGN(auto edge, storage::LoadEdge(context.store, id));
  if (!edge) {
    RIGCAL_ASSIGN(const auto found, FindMerged(context.store, id, robot));
    if (found) edge = graph::EdgeOf(found->merged, found->robot);
  }
  if (edge) return formats::WriteEdge(*edge);
  return Fail(ErrorCode::kNotFound, "edge " + id.str() + " is not known", "`rigcal edges ROBOT` lists those that are.");
}

// A document of format 1 is whole as it is.
Result<std::string> WholeDocumentOf(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(auto document, formats::ReadRevisionDocument(revision.document));
  if (document.whole) return revision.document;
  RIGCAL_ASSIGN(const auto whole, WithWholeEdges(store, revision.number, std::move(document), Blocks::kLeftOut));
  return formats::WriteWholeRevisionDocument(whole);
}

// Of a robot without sessions nothing is read.
Result<std::vector<BoardRemark>> BoardRemarksOf(const AnswerContext& context, const Revision& revision) {
  RIGCAL_ASSIGN(const auto captured, storage::LoadNewestCapture(context.store, revision.robot));
  if (!captured) return std::vector<BoardRemark>();
  RIGCAL_ASSIGN(const ParsedRevision parsed, context.revisions.Load(context.store, revision.robot, revision.number));
  return LoadBoardRemarks(context.store, SessionsCountedIn(parsed.document->edges));
}

Result<std::string> Show(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("revision", 0));
  RIGCAL_ASSIGN(const bool whole, parameters.Flag("whole"));
  RIGCAL_ASSIGN(Revision revision, LoadRevisionOf(context.store, robot, number));
  if (whole) {
    RIGCAL_ASSIGN(revision.document, WholeDocumentOf(context.store, revision));
  }
  RIGCAL_ASSIGN(const bool is_published, storage::IsPublished(context.store, {robot, revision.number}));
  const Stamp now = context.clock.Now();
  RIGCAL_ASSIGN(const Validity validity, LoadValidity(context.store, revision, now));
  RIGCAL_ASSIGN(const Approval approval, LoadApproval(context.store, revision));
  RIGCAL_ASSIGN(const auto runs, LoadWhatRuns(context.store, robot));
  RIGCAL_ASSIGN(const auto as_found, storage::LoadAsFound(context.store, {robot, revision.number}));
  RIGCAL_ASSIGN(const auto remarks, BoardRemarksOf(context, revision));
  return formats::WriteShow(revision, is_published, validity, now, approval, runs, as_found, remarks);
}

Result<std::string> Sensors(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("revision", 0));
  RIGCAL_ASSIGN(const Revision revision, LoadRevisionOf(context.store, robot, number));
  RIGCAL_ASSIGN(const auto facts, LoadSensorFacts(context.store, revision));
  return formats::WriteSensorFacts(facts);
}

Status TakeList(const AnswerContext& context, const Parameters& parameters, formats::StatusAnswer& answer) {
  RIGCAL_ASSIGN(RobotList list, LoadRobotList(context.store, context.clock, parameters));
  answer.robots = std::move(list.robots);
  answer.next = std::move(list.next);
  RIGCAL_ASSIGN(answer.jobs_waiting, storage::CountJobs(context.store));
  return {};
}

Status TakeOne(const AnswerContext& context, const RobotId& robot, Stamp now, formats::StatusAnswer& answer) {
  RIGCAL_ASSIGN(RobotSummary summary, LoadRobotSummary(context.store, robot, now));
  answer.jobs_waiting = summary.jobs_waiting;
  answer.robots.push_back(std::move(summary));
  return {};
}

Result<std::string> OfStatus(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, OptionalId<RobotId>(parameters, "robot"));
  const Stamp now = context.clock.Now();
  formats::StatusAnswer answer;
  answer.version = std::string(Version());
  answer.http_address = context.http_address;
  answer.uptime_ns = now.ns - context.started_at.ns;
  answer.problem = LookAtHealth(context).problem();
  RIGCAL_TRY(robot.empty() ? TakeList(context, parameters, answer) : TakeOne(context, robot, now, answer));
  RIGCAL_ASSIGN(const auto batches, storage::LoadOpenBatches(context.store, robot));
  for (const auto& one : batches)
    answer.open_batches.push_back({one.id, one.robot, one.items, one.held, one.opened_at, one.newest_at});
  return formats::WriteStatus(answer, now);
}

Result<std::string> ListBoards(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const auto answer, LoadBoardsAnswer(context.store, context.clock.Now(), parameters));
  return formats::WriteBoards(answer);
}

Result<std::string> Live(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, OptionalId<RobotId>(parameters, "robot"));
  if (!robot.empty()) RIGCAL_TRY(KnownRobot(context.store, parameters));
  return LiveDocument(context.store, robot);
}

// 0, or none: the newest.
Result<int> ReportNumber(const AnswerContext& context, const RobotId& robot, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("revision", 0));
  RIGCAL_ASSIGN(const Revision revision, LoadRevisionSummaryOf(context.store, robot, number));
  return revision.number;
}

Result<std::string> FilesOfReport(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const int number, ReportNumber(context, robot, parameters));
  auto files = ReportFiles(context.store, robot, number);
  return files ? std::move(files) : Fail(WhyMissing(context, robot, number, "index.html"));
}

Result<std::string> FileOfReport(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const int number, ReportNumber(context, robot, parameters));
  RIGCAL_ASSIGN(const std::int64_t offset, parameters.IntegerOr("offset", 0));
  return ReportFile(context.store, robot, number, parameters.Text("path").value_or(""), offset);
}

Result<std::string> Due(const AnswerContext& context, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::int64_t max_age_ns, parameters.IntegerOr("max_age_ns", 0));
  if (max_age_ns < 0)
    return Fail(ErrorCode::kInvalidInput, "the parameter 'max_age_ns' is negative", "Give an age such as 90d.");
  RIGCAL_ASSIGN(const RobotList list, LoadRobotList(context.store, context.clock, parameters));
  const auto asked = parameters.Text("max_age_ns") ? std::optional(max_age_ns) : std::nullopt;
  return formats::WriteDue(list.robots, asked, context.clock.Now(), list.next);
}

Status TakeLostFiles(storage::Store& store, formats::HealthAnswer& answer) {
  constexpr std::size_t kNamedMax = 20;
  RIGCAL_ASSIGN(const storage::LostPayloads lost, storage::LoadLost(store, kNamedMax));
  answer.lost_files = lost.count;
  for (const storage::LostPayload& one : lost.first)
    answer.first_lost_files.push_back({one.robot, one.session, one.path, one.state == storage::BlobState::kMissing});
  return {};
}

Result<std::string> Health(const AnswerContext& context, const Parameters&) {
  formats::HealthAnswer answer = LookAtHealth(context);
  // A database that cannot be read is told as a part that fails.
  if (const Status taken = TakeLostFiles(context.store, answer); !taken && !answer.problem())
    return Fail(taken.error());
  return formats::WriteHealth(answer, context.clock.Now());
}

// Of one that needs the store alone.
Verb OfStore(Result<std::string> (*tell)(storage::Store&, const Parameters&)) {
  return [tell](const AnswerContext& context, const Parameters& parameters) { return tell(context.store, parameters); };
}

std::map<std::string, Verb> MakeVerbs() {
  std::map<std::string, Verb> verbs = {
      {"robots", Robots},
      {"session", Session},
      {"edge", OneEdge},
      {"show", Show},
      {"certificate", TellCertificate},
      {"sensors", Sensors},
      {"lookup", TellRelativePose},
      {"status", OfStatus},
      {"policy", OfStore(TellPolicy)},
      {"rig_model", OfStore(TellRigModel)},
      {"rig_models", [](const AnswerContext& context, const Parameters&) { return ListRigModels(context.store); }},
      {"population", OfStore(TellPopulation)},
      {"boards", ListBoards},
      {"board",
       [](const AnswerContext& of, const Parameters& asked) { return TellBoard(of.store, of.clock.Now(), asked); }},
      {"board_trace", OfStore(TraceBoard)},
      {"recomputation", OfStore(TellRecomputation)},
      {"due", Due},
      {"health", Health},
      {"live", Live},
      {"report_files", FilesOfReport},
      {"report_file", FileOfReport},
  };
  for (const auto& listed : {ListVerbs(), NameVerbs()})
    for (const VerbAnswer& one : listed) verbs.emplace(one.verb, one.answer);
  return verbs;
}

const std::map<std::string, Verb>& Verbs() {
  static const std::map<std::string, Verb> verbs = MakeVerbs();
  return verbs;
}

}  // namespace

formats::HealthAnswer LookAtHealth(const AnswerContext& context) {
  ServerHealth alone(context.store.folder(), context.clock);
  ServerHealth::Found found = (context.health == nullptr ? alone : *context.health).Look(context.store);
  formats::HealthAnswer answer;
  answer.version = std::string(Version());
  answer.http_address = context.http_address;
  answer.uptime_ns = context.clock.Now().ns - context.started_at.ns;
  answer.schema = context.store.SchemaVersion();
  answer.protocol = kWireProtocol;
  answer.limits = limits::InForce();
  answer.disk_free_bytes = found.disk_free_bytes;
  answer.parts = std::move(found.parts);
  return answer;
}

Error WhyMissing(const AnswerContext& context, const RobotId& robot, int number, const std::string& file) {
  static const UndrawnReports none;
  const UndrawnReports& undrawn = context.undrawn == nullptr ? none : *context.undrawn;
  return WhyMissing(context.store, undrawn, {robot, number}, file, context.work_arrived);
}

Result<std::string> Answer(const AnswerContext& context, const std::string& verb, const std::string& json) {
  const auto found = Verbs().find(verb);
  if (found == Verbs().end())
    return Fail(ErrorCode::kInvalidInput, "the verb '" + verb.substr(0, 32) + "' is not known",
                "docs/api.md lists the verbs.");
  RIGCAL_ASSIGN(const Parameters parameters, Parameters::Read(json));
  return found->second(context, parameters);
}

}  // namespace rigcal::pipeline
