#include "server/pipeline/reports/report_input.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "server/calib/camera/projection_maps.h"
#include "server/fleet/assess.h"
#include "server/fleet/boards/remarks.h"
#include "server/model/graph/unchecked.h"
#include "server/pipeline/boards/seen_boards.h"
#include "server/pipeline/edges/camera_fits.h"
#include "server/pipeline/revisions/whole_revision.h"
#include "server/pipeline/sessions/refined_lenses.h"
#include "server/report/boards/boards_page.h"
#include "server/report/edges/edge_order.h"
#include "storage/boards/measures.h"
#include "storage/boards/uses.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revision_made.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {
namespace {

std::string BoardText(const Target& target) {
  const auto size_um = static_cast<long long>(target.square_m * 1e6 + 0.5);
  std::string size = std::to_string(size_um / 1000);
  if (size_um % 1000 != 0) size += "." + std::to_string(1000 + size_um % 1000).substr(1);
  return target.id.str() + ": " + NameOf(target.kind) + " " + std::to_string(target.cols) + " x " +
         std::to_string(target.rows) + ", " + size + " mm" + (target.serial.empty() ? "" : ", serial " + target.serial);
}

report::SessionFacts FactsOf(const SessionId& id, const Manifest& manifest) {
  report::SessionFacts facts;
  facts.id = id;
  facts.captured_at = manifest.header.captured_at;
  facts.operator_name = manifest.header.operator_name;
  facts.rig_model = manifest.header.rig_model;
  facts.files = manifest.payloads.size();
  facts.conditions = manifest.header.conditions;
  return facts;
}

// With what the registry has of them.
Status TakeBoards(storage::Store& store, const Manifest& manifest, report::SessionFacts& facts) {
  RIGCAL_ASSIGN(const auto boards, storage::LoadSessionBoards(store, {facts.id}));
  RIGCAL_ASSIGN(const BoardRegistry registry, storage::LoadRegistryOf(store, boards));
  facts.board_remarks = fleet::RemarksOn(boards, registry);
  RIGCAL_ASSIGN(const auto seen, LoadBoardsSeen(store, manifest));
  LeaveOutUnseen(seen, facts.board_remarks);
  for (const Target& target : manifest.header.targets) {
    std::string text = BoardText(target);
    for (const SessionBoard& board : boards)
      if (board.target == target.id) text += report::StandardText(board, registry, facts.board_remarks);
    const BoardSeen is_seen = seen.at(target.id);
    (is_seen == BoardSeen::kYes  ? facts.boards
     : is_seen == BoardSeen::kNo ? facts.boards_unseen
                                 : facts.boards_perhaps_seen)
        .push_back(std::move(text));
  }
  return {};
}

// Of the reference itself the nominal pose is known without being said.
void TakeSensors(const SessionHeader& header, report::ReportInput& input) {
  for (const Sensor& sensor : header.sensors) {
    report::SensorFacts facts;
    facts.kind = sensor.kind;
    if (header.reference == input.revision.reference) facts.T_ref_nominal = sensor.T_ref_nominal;
    input.sensors.emplace(sensor.id, facts);
  }
}

// The newest session that names a sensor says what it is.
Status TakeSessions(storage::Store& store, report::ReportInput& input) {
  std::set<SessionId> ids;
  for (const Edge& edge : input.revision.edges)
    if (!edge.session.empty()) ids.insert(edge.session);
  std::vector<SessionHeader> headers;
  for (const SessionId& id : ids) {
    RIGCAL_ASSIGN(auto manifest, storage::LoadManifest(store, id));
    if (!manifest) continue;
    input.sessions.push_back(FactsOf(id, *manifest));
    RIGCAL_TRY(TakeBoards(store, *manifest, input.sessions.back()));
    headers.push_back(std::move(manifest->header));
  }
  std::stable_sort(headers.begin(), headers.end(),
                   [](const SessionHeader& a, const SessionHeader& b) { return a.captured_at > b.captured_at; });
  for (const SessionHeader& header : headers) TakeSensors(header, input);
  return {};
}

void TakeBlocks(report::ReportInput& input) {
  for (Edge& edge : input.revision.edges)
    if (!edge.uncertainty.blocks.empty()) input.blocks.emplace(edge.id, std::move(edge.uncertainty.blocks));
}

void TakeLimits(report::ReportInput& input) {
  std::map<EdgeId, const Edge*> edges;
  for (const Edge& edge : input.revision.edges) edges.emplace(edge.id, &edge);
  if (input.revision.solution.dof <= 0) return;
  const auto& residuals = input.revision.solution.residuals;
  const std::set<EdgeId> unchecked = UncheckedEdges(input.revision.solution);
  for (const EdgeResidual& residual : residuals) {
    const auto edge = edges.find(residual.edge);
    if (edge == edges.end() || unchecked.contains(residual.edge)) continue;
    const fleet::EdgeTest test = fleet::TestResidual(*edge->second, residual, residuals.size());
    input.limits.emplace(residual.edge, report::EdgeLimit{test.statistic, test.limit});
  }
}

Status TakePrevious(storage::Store& store, report::ReportInput& input) {
  if (input.number <= 1) return {};
  RIGCAL_ASSIGN(const auto before, storage::LoadRevision(store, input.revision.robot, input.number - 1));
  if (!before) return {};
  report::PastRevision past;
  past.number = before->number;
  RIGCAL_ASSIGN(past.revision, formats::ReadRevisionDocument(before->document));
  input.previous = std::move(past);
  return {};
}

Status TakeCameras(storage::Store& store, report::ReportInput& input) {
  std::map<SessionId, Stamp> captured_at;
  for (const report::SessionFacts& session : input.sessions) captured_at.emplace(session.id, session.captured_at);
  RIGCAL_ASSIGN(input.cameras, LoadFits(store, report::ChooseFits(input.revision, captured_at)));
  RIGCAL_TRY(TakeRefinedLenses(store, input.revision, input.cameras));
  for (report::CameraReport& camera : input.cameras) camera.uncertainty = calib::UncertaintyOfProjections(camera.fit);
  return {};
}

// Captured last; of several the one with the larger id.
SessionId NewestOf(const std::vector<report::SessionFacts>& sessions) {
  const auto newest = std::max_element(sessions.begin(), sessions.end(), [](const auto& x, const auto& y) {
    return std::tie(x.captured_at.ns, x.id) < std::tie(y.captured_at.ns, y.id);
  });
  return newest == sessions.end() ? SessionId() : newest->id;
}

// The first revision that had all of each session.
Result<std::map<SessionId, int>> LoadRevisionsOf(storage::Store& store, const report::ReportInput& input,
                                                 std::int64_t watermark) {
  std::vector<SessionId> sessions;
  for (const report::SessionFacts& facts : input.sessions) sessions.push_back(facts.id);
  return storage::LoadFirstRevisions(store, input.revision.robot, watermark, sessions);
}

// Edges of earlier visits whose pictures and captures stay on the reports of those visits, for
// ReportInput::detailed_in; `input` as it is without. A report has the details of what is new in it, of its newest
// session, of pushed edges, of those that speak for a camera, and of what is worth looking at again
// (report::WorthDetails): so it costs the same however many visits the robot's window holds. `watermark`: of the
// revision.
Result<std::map<EdgeId, int>> LoadDetailedEarlier(storage::Store& store, const report::ReportInput& input,
                                                  std::int64_t watermark) {
  RIGCAL_ASSIGN(const auto first, LoadRevisionsOf(store, input, watermark));
  const SessionId newest = NewestOf(input.sessions);
  std::set<EdgeId> here = report::WorthDetails(input);
  for (const report::CameraReport& camera : input.cameras) here.insert(camera.edge);
  std::map<EdgeId, int> earlier;
  for (const Edge& edge : input.revision.edges) {
    const auto number = first.find(edge.session);
    if (number == first.end() || number->second >= input.number || edge.session == newest) continue;
    if (!here.contains(edge.id)) earlier.emplace(edge.id, number->second);
  }
  return earlier;
}

// What the robot was to use when the revision was made. One of before did not keep it: then by what was decided so far.
Result<std::optional<UsableRevision>> LoadUsableThen(storage::Store& store, const Revision& revision,
                                                     const std::optional<storage::RevisionMade>& made) {
  std::optional<Revision> then;
  if (!made) {
    RIGCAL_ASSIGN(then, storage::LoadStillUsable(store, revision.robot, revision.number, revision.created_at));
  } else if (made->in_use) {
    RIGCAL_ASSIGN(then, storage::LoadRevisionSummary(store, revision.robot, *made->in_use));
  }
  if (!then) return std::nullopt;
  return UsableRevision{then->number, then->created_at, then->calibrated_at, then->max_age_ns};
}

constexpr const char* kVersionNotKept = "of a version that was not recorded";

// As its report and certificate tell it, whenever they are drawn.
Result<report::ReportInput> LoadSummary(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(const auto made, storage::LoadRevisionMade(store, {revision.robot, revision.number}));
  report::ReportInput input;
  input.number = revision.number;
  input.created_at = revision.created_at;
  input.digest = revision.digest;
  input.software_version = made ? made->software : kVersionNotKept;
  RIGCAL_ASSIGN(input.usable, LoadUsableThen(store, revision, made));
  input.calibrated_at = revision.calibrated_at;
  input.max_age_ns = revision.max_age_ns;
  return input;
}

}  // namespace

Result<report::ReportInput> LoadReportInput(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(report::ReportInput input, LoadSummary(store, revision));
  RIGCAL_ASSIGN(input.revision, LoadWholeRevision(store, revision, Blocks::kLoaded));
  TakeBlocks(input);
  RIGCAL_TRY(TakeSessions(store, input));
  RIGCAL_TRY(TakePrevious(store, input));
  RIGCAL_ASSIGN(input.as_found, storage::LoadAsFound(store, {revision.robot, revision.number}));
  TakeLimits(input);
  RIGCAL_TRY(TakeCameras(store, input));
  RIGCAL_ASSIGN(input.detailed_in, LoadDetailedEarlier(store, input, revision.edge_watermark));
  return input;
}

Result<report::ReportInput> LoadCertificateInput(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(report::ReportInput input, LoadSummary(store, revision));
  RIGCAL_ASSIGN(input.revision, formats::ReadRevisionDocument(revision.document));
  RIGCAL_TRY(TakeSessions(store, input));
  RIGCAL_ASSIGN(input.as_found, storage::LoadAsFound(store, {revision.robot, revision.number}));
  return input;
}

}  // namespace rigcal::pipeline
