#include "server/formats/answers/answers.h"

#include "server/formats/alerts/status_fields.h"
#include "server/formats/answers/answer_rows.h"
#include "server/formats/boards/answers.h"
#include "server/formats/edges/edge_fields.h"
#include "server/formats/json/json_values.h"
#include "server/formats/revision/as_found.h"
#include "server/formats/revision/measured_part_fields.h"
#include "server/formats/rig_models/rig_model_answers.h"
#include "server/formats/sessions/manifest_fields.h"
#include "server/model/robots/drive_rule.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kErrorBytesMax = 64u << 10;

void WriteAge(JsonWriter& out, const std::optional<Stamp>& since, Stamp now) {
  since ? out.Integer("age_ns", now.ns - since->ns) : out.Null("age_ns");
}

void WriteValidity(JsonWriter& out, const Validity& validity) {
  WriteStamp(out, "calibrated_at", validity.calibrated_at);
  WriteStamp(out, "valid_until", ValidUntil(validity));
  out.Flag("overdue", validity.overdue);
  WriteUsable(out, validity.usable);
  if (validity.superseded_by) out.Integer("superseded_by", *validity.superseded_by);
  out.Flag("calculating", validity.calculating);
  validity.given_up.empty() ? out.Null("given_up") : out.Text("given_up", validity.given_up);
}

void WriteDrive(JsonWriter& out, const Verdict& verdict, const Validity& validity,
                const std::optional<Runs>& runs = {}) {
  const DriveRule drive = DriveRuleOf(verdict, validity, runs);
  out.Object("drive", [&] {
    out.Text("kind", NameOf(drive.kind));
    out.Text("rule", drive.rule);
    WriteStamp(out, "until", drive.until);
  });
}

void WriteRobotRow(JsonWriter& out, const RobotSummary& robot, Stamp now) {
  out.Object([&] {
    out.Text("robot", robot.robot.str());
    WriteRevisionNumber(out, robot.revision);
    WriteVerdict(out, "verdict", robot.verdict);
    robot.revision > 0 ? out.Text("state", NameOf(robot.state)) : out.Null("state");
    WriteRuns(out, robot.runs);
    WriteValidity(out, robot.validity);
    WriteDrive(out, robot.verdict, robot.validity, robot.runs);
    WriteAge(out, robot.validity.calibrated_at, now);
    WriteStatusMembers(out, robot, now);
    out.Integer("sessions", robot.sessions);
    out.Integer("edges", robot.edges);
    out.Integer("jobs_waiting", robot.jobs_waiting);
  });
}

void WriteRobotRows(JsonWriter& out, const std::vector<RobotSummary>& robots, Stamp now) {
  out.List("robots", [&] {
    for (const RobotSummary& robot : robots) WriteRobotRow(out, robot, now);
  });
}

void WriteNext(JsonWriter& out, const std::optional<RobotId>& next) {
  if (!next) return;
  next->empty() ? out.Null("next") : out.Text("next", next->str());
}

void WriteOpenBatch(JsonWriter& out, const OpenBatchAnswer& batch, Stamp now) {
  out.Text("batch", batch.batch.str());
  out.Text("robot", batch.robot.str());
  out.Integer("edges", batch.items);
  out.Integer("held", batch.held);
  WriteStamp(out, "opened_at", batch.opened_at);
  WriteStamp(out, "newest_at", batch.newest_at);
  WriteAge(out, batch.newest_at, now);
}

void WriteAddress(JsonWriter& out, const std::string& http_address) {
  if (http_address.empty()) return out.Null("http_address");
  out.Text("http_address", http_address);
}

void WriteProblem(JsonWriter& out, const std::optional<Error>& problem) {
  if (!problem) return out.Null("problem");
  out.Object("problem", [&] { WriteErrorMembers(out, *problem); });
}

void WritePart(JsonWriter& out, const PartState& part) {
  out.Object([&] {
    out.Text("name", part.name);
    out.Integer("failures", part.failures);
    WriteProblem(out, part.problem);
    WriteStamp(out, "since", part.problem ? std::optional(part.since) : std::nullopt);
  });
}

void WriteWholePose(JsonWriter& out, const LookupAnswer& answer) {
  WritePose(out, "T_a_b", answer.T_a_b);
  WriteMatrix(out, "covariance", answer.covariance);
  WriteSigmas(out, answer.covariance);
}

// Who wants a whole pose finds none.
void WritePoseInPart(JsonWriter& out, const LookupAnswer& answer) {
  for (const char* key : {"T_a_b", "covariance"}) out.Null(key);
  WriteNoSigmas(out);
  WriteOpenDirections(out, answer.unobservable_basis);
  WriteRobotAxes(out, answer.R_a_robot);
  out.Object("measured_part", [&] {
    WritePose(out, "T_a_b", answer.T_a_b);
    WriteMatrix(out, "covariance", answer.covariance);
    WriteAxes(out, AxesOf(answer.T_a_b, answer.covariance, answer.unobservable_basis, answer.R_a_robot));
  });
}

void WriteNext(JsonWriter& out, const NextPage& next) {
  if (next) next->empty() ? out.Null("next") : out.Text("next", *next);
}

}  // namespace

std::string WriteRobots(const std::vector<RobotSummary>& robots, Stamp now, const std::optional<RobotId>& next) {
  return WriteObject([&](JsonWriter& out) {
    WriteRobotRows(out, robots, now);
    WriteNext(out, next);
  });
}

std::string WriteSessions(const std::vector<SessionAnswer>& sessions, const NextPage& next) {
  return WriteObject([&](JsonWriter& out) {
    WriteNext(out, next);
    out.List("sessions", [&] {
      for (const SessionAnswer& session : sessions) out.Object([&] { WriteSessionMembers(out, session); });
    });
  });
}

std::string WriteSession(const SessionAnswer& session, const Manifest& manifest, const std::vector<Edge>& edges,
                         const std::vector<RetiredSensor>& retired, const std::string& lacking,
                         const std::vector<BoardRemark>& remarks) {
  return WriteObject([&](JsonWriter& out) {
    WriteBoardRemarks(out, remarks);
    out.Object("session", [&] { WriteSessionMembers(out, session); });
    out.Object("manifest", [&] { WriteManifestMembers(out, manifest); });
    out.List("edges", [&] {
      for (const Edge& edge : edges) out.Object([&] { WriteEdgeRowMembers(out, edge, nullptr); });
    });
    WriteRetiredSensors(out, retired);
    if (!lacking.empty()) out.Text("lacking", lacking);
  });
}

std::string WriteEdges(const RobotId& robot, int revision, const std::vector<Edge>& edges,
                       const std::vector<EdgeResidual>& residuals, const NextPage& next) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    WriteRevisionNumber(out, revision);
    WriteNext(out, next);
    out.List("edges", [&] {
      for (const Edge& edge : edges)
        out.Object([&] { WriteEdgeRowMembers(out, edge, ResidualOf(residuals, edge.id)); });
    });
  });
}

std::string WriteShow(const Revision& revision, bool is_published, const Validity& validity, Stamp now,
                      const Approval& approval, const std::optional<Runs>& runs, const std::optional<AsFound>& as_found,
                      const std::vector<BoardRemark>& remarks) {
  std::string text = WriteObject([&](JsonWriter& out) {
    WriteBoardRemarks(out, remarks);
    WriteRevisionMembers(out, revision);
    WriteAge(out, revision.created_at, now);
    WriteValidity(out, validity);
    WriteDrive(out, revision.verdict, validity, runs);
    WriteApproval(out, approval);
    WriteRuns(out, runs);
    out.Flag("published", is_published);
    out.Integer("standing", revision.standing_watermark);
    if (as_found) out.Object("as_found", [&] { WriteAsFoundMembers(out, *as_found); });
    out.Null("document");
  });
  // Byte for byte, so that whoever reads the answer can check the digest. Free text before it has its quotation marks
  // escaped.
  const std::string place = "\"document\":null";
  return text.replace(text.find(place) + place.size() - 4, 4, revision.document);
}

std::string WriteRevisions(const RobotId& robot, const std::vector<Revision>& revisions, Stamp now,
                           const std::optional<int>& next, const std::vector<Approval>& approvals,
                           const std::map<int, AsFoundSummary>& as_found, const std::vector<Epoch>& epochs) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    if (next) *next > 0 ? out.Integer("next", *next) : out.Null("next");
    WriteEpochs(out, epochs);
    out.List("revisions", [&] {
      for (std::size_t i = 0; i < revisions.size(); ++i)
        out.Object([&] {
          WriteRevisionMembers(out, revisions[i]);
          WriteAge(out, revisions[i].created_at, now);
          WriteVerdict(out, "verdict", revisions[i].verdict);
          if (i < approvals.size()) WriteApproval(out, approvals[i]);
          if (const auto found = as_found.find(revisions[i].number); found != as_found.end())
            out.Object("as_found", [&] { WriteAsFoundMembers(out, found->second); });
        });
    });
  });
}

std::string WriteLookup(const LookupAnswer& answer) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", answer.robot.str());
    WriteRevisionNumber(out, answer.revision);
    out.Text("frame_a", answer.frame_a.str());
    out.Text("frame_b", answer.frame_b.str());
    out.Flag("known", answer.unobservable_basis.empty());
    answer.unobservable_basis.empty() ? WriteWholePose(out, answer) : WritePoseInPart(out, answer);
    WriteVerdict(out, "verdict", answer.verdict);
    WriteValidity(out, answer.validity);
    WriteDrive(out, answer.verdict, answer.validity, answer.runs);
    WriteApproval(out, answer.approval);
  });
}

std::string WriteStatus(const StatusAnswer& answer, Stamp now) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("version", answer.version);
    out.Text("now", ToIso(now));
    out.Integer("uptime_ns", answer.uptime_ns);
    out.Integer("jobs_waiting", answer.jobs_waiting);
    WriteAddress(out, answer.http_address);
    WriteProblem(out, answer.problem);
    out.List("open_batches", [&] {
      for (const OpenBatchAnswer& batch : answer.open_batches) out.Object([&] { WriteOpenBatch(out, batch, now); });
    });
    WriteRobotRows(out, answer.robots, now);
    WriteNext(out, answer.next);
  });
}

std::string WriteLive(const LiveAnswer& answer) {
  return WriteObject([&](JsonWriter& out) {
    answer.robot.empty() ? out.Null("robot") : out.Text("robot", answer.robot.str());
    out.Integer("robots", answer.robots);
    out.Integer("sessions", answer.sessions);
    out.Integer("edges", answer.edges);
    out.Integer("unfinished", answer.unfinished);
    WriteRevisionNumber(out, answer.revision);
    out.List("open_sessions", [&] {
      for (const SessionAnswer& session : answer.open_sessions) out.Object([&] { WriteSessionMembers(out, session); });
    });
  });
}

std::string WriteRobotNames(const std::vector<RobotId>& robots, bool more) {
  return WriteObject([&](JsonWriter& out) {
    WriteIds(out, "robots", robots);
    out.Flag("more", more);
  });
}

std::string WriteSensorNames(const RobotId& robot, const std::vector<SensorId>& sensors, bool more) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    WriteIds(out, "sensors", sensors);
    out.Flag("more", more);
  });
}

std::string WriteKnownRobot(const RobotId& robot, bool is_known, const std::vector<RobotId>& slip_of) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    out.Flag("known", is_known);
    WriteIds(out, "slip_of", slip_of);
  });
}

std::string WriteKnownFiles(std::size_t asked, const std::optional<FilesOfAnother>& another) {
  return WriteObject([&](JsonWriter& out) {
    out.Integer("asked", static_cast<std::int64_t>(asked));
    out.Integer("files", another ? static_cast<std::int64_t>(another->files) : 0);
    if (!another) return;
    out.Text("robot", another->robot.str());
    out.Text("session", another->session.str());
    out.Text("captured_at", ToIso(another->captured_at));
  });
}

std::string WriteDue(const std::vector<RobotSummary>& robots, std::optional<std::int64_t> max_age_ns, Stamp now,
                     const std::optional<RobotId>& next) {
  const auto write_row = [&](JsonWriter& out, const RobotSummary& robot) {
    const std::optional<Stamp>& calibrated_at = robot.validity.calibrated_at;
    out.Text("robot", robot.robot.str());
    WriteStamp(out, "calibrated_at", calibrated_at);
    WriteAge(out, calibrated_at, now);
    out.Flag("overdue", IsOverdue(calibrated_at, max_age_ns.value_or(robot.validity.max_age_ns), now));
    WriteVerdict(out, "verdict", robot.verdict);
    WriteStatusMembers(out, robot, now);
  };
  return WriteObject([&](JsonWriter& out) {
    max_age_ns ? out.Integer("max_age_ns", *max_age_ns) : out.Null("max_age_ns");
    out.Text("now", ToIso(now));
    out.List("robots", [&] {
      for (const RobotSummary& robot : robots) out.Object([&] { write_row(out, robot); });
    });
    WriteNext(out, next);
  });
}

std::optional<Error> HealthAnswer::problem() const {
  for (const PartState& part : parts)
    if (part.problem) return part.problem;
  return std::nullopt;
}

namespace {

void WriteLostFiles(JsonWriter& out, const HealthAnswer& answer) {
  out.Integer("count", answer.lost_files);
  out.List("first", [&] {
    for (const LostFileAnswer& file : answer.first_lost_files)
      out.Object([&] {
        out.Text("path", file.path);
        out.Text("robot", file.robot.str());
        out.Text("session", file.session.str());
        out.Text("state", file.missing ? "missing" : "damaged");
      });
  });
}

}  // namespace

std::string WriteHealth(const HealthAnswer& answer, Stamp now) {
  return WriteObject([&](JsonWriter& out) {
    const std::optional<Error> problem = answer.problem();
    out.Text("state", problem ? "failing" : "ok");
    out.Text("version", answer.version);
    out.Integer("protocol", answer.protocol);
    out.Integer("schema", answer.schema);
    out.Integer("uptime_ns", answer.uptime_ns);
    out.Integer("disk_free_bytes", answer.disk_free_bytes);
    out.Text("now", ToIso(now));
    WriteAddress(out, answer.http_address);
    out.Object("limits", [&] {
      for (const limits::Setting& one : limits::Settings()) out.Integer(one.name, answer.limits.*one.value);
    });
    out.List("parts", [&] {
      for (const PartState& part : answer.parts) WritePart(out, part);
    });
    out.Object("lost_files", [&] { WriteLostFiles(out, answer); });
    WriteProblem(out, problem);
  });
}

std::string WriteError(const Error& error) {
  return WriteObject([&](JsonWriter& out) { out.Object("error", [&] { WriteErrorMembers(out, error); }); });
}

std::optional<Error> ReadError(std::string_view text) {
  if (text.substr(0, 9) != "{\"error\":") return std::nullopt;
  Result<JsonDocument> document = JsonDocument::Parse(text, {"error", "", kErrorBytesMax});
  if (!document) return std::nullopt;
  const JsonField field = document->Root().At("error");
  Error error{ErrorCodeOf(field.At("code").Text()), field.At("what").Text(), field.At("cure").Text()};
  if (!document->status()) return std::nullopt;
  return error;
}

}  // namespace rigcal::formats
