#include "server/formats/answers.h"

#include "server/formats/edge_fields.h"
#include "server/formats/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kErrorBytesMax = 64u << 10;

void WriteAge(JsonWriter& out, const std::optional<Stamp>& since, Stamp now) {
  since ? out.Integer("age_ns", now.ns - since->ns) : out.Null("age_ns");
}

void WriteRobotRow(JsonWriter& out, const RobotAnswer& robot, Stamp now) {
  out.Object([&] {
    out.Text("robot", robot.robot.str());
    WriteRevisionNumber(out, robot.revision);
    WriteVerdict(out, "verdict", robot.verdict);
    WriteStamp(out, "calibrated_at", robot.calibrated_at);
    WriteAge(out, robot.calibrated_at, now);
    out.Integer("sessions", robot.sessions);
    out.Integer("edges", robot.edges);
    out.Integer("jobs_waiting", robot.jobs_waiting);
    out.Flag("overdue", robot.overdue);
  });
}

void WriteRobotRows(JsonWriter& out, const std::vector<RobotAnswer>& robots, Stamp now) {
  out.List("robots", [&] {
    for (const RobotAnswer& robot : robots) WriteRobotRow(out, robot, now);
  });
}

void WriteSessionMembers(JsonWriter& out, const SessionAnswer& session) {
  out.Text("session", session.session.str());
  out.Text("robot", session.robot.str());
  out.Text("state", session.closed ? "closed" : "receiving");
  out.Integer("payloads", session.payloads);
  out.Integer("payloads_held", session.payloads_held);
  out.Integer("bytes", session.bytes);
  WriteStamp(out, "captured_at", session.captured_at);
  WriteStamp(out, "opened_at", session.opened_at);
  WriteStamp(out, "closed_at", session.closed_at);
  out.Text("operator", session.operator_name);
  out.Integer("jobs_waiting", session.jobs_waiting);
  out.Integer("jobs_total", session.jobs_total);
}

void WriteEdgeRow(JsonWriter& out, const Edge& edge, const EdgeResidual* residual) {
  out.Object([&] {
    WriteEdgeSummary(out, edge);
    WriteResidual(out, residual);
  });
}

void WriteRevisionMembers(JsonWriter& out, const Revision& revision) {
  out.Text("robot", revision.robot.str());
  out.Integer("revision", revision.number);
  out.Text("created_at", ToIso(revision.created_at));
  out.Text("digest", revision.digest.str());
}

// A stored document goes in byte for byte, so that its digest can be checked by whoever reads the answer.
std::string WithMember(std::string text, std::string_view key, const std::string& document) {
  const std::string place = "\"" + std::string(key) + "\":null";
  const std::size_t at = text.find(place);
  return text.replace(at + place.size() - 4, 4, document);
}

}  // namespace

std::string WriteRobots(const std::vector<RobotAnswer>& robots, Stamp now) {
  return WriteObject([&](JsonWriter& out) { WriteRobotRows(out, robots, now); });
}

std::string WriteSessions(const std::vector<SessionAnswer>& sessions) {
  return WriteObject([&](JsonWriter& out) {
    out.List("sessions", [&] {
      for (const SessionAnswer& session : sessions) out.Object([&] { WriteSessionMembers(out, session); });
    });
  });
}

std::string WriteSession(const SessionAnswer& session, const Manifest& manifest, const std::vector<Edge>& edges) {
  const std::string text = WriteObject([&](JsonWriter& out) {
    out.Object("session", [&] { WriteSessionMembers(out, session); });
    // Sorted before every free text of this document: the place is found at its first occurrence.
    out.Null("manifest");
    out.List("edges", [&] {
      for (const Edge& edge : edges) WriteEdgeRow(out, edge, nullptr);
    });
  });
  return WithMember(text, "manifest", WriteManifest(manifest));
}

std::string WriteEdges(const RobotId& robot, int revision, const std::vector<Edge>& edges,
                       const std::vector<EdgeResidual>& residuals) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    WriteRevisionNumber(out, revision);
    out.List("edges", [&] {
      for (const Edge& edge : edges) WriteEdgeRow(out, edge, ResidualOf(residuals, edge.id));
    });
  });
}

std::string WriteShow(const Revision& revision, Stamp now) {
  const std::string text = WriteObject([&](JsonWriter& out) {
    WriteRevisionMembers(out, revision);
    WriteAge(out, revision.created_at, now);
    out.Null("document");
  });
  return WithMember(text, "document", revision.document);
}

std::string WriteRevisions(const RobotId& robot, const std::vector<Revision>& revisions, Stamp now) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    out.List("revisions", [&] {
      for (const Revision& revision : revisions)
        out.Object([&] {
          WriteRevisionMembers(out, revision);
          WriteAge(out, revision.created_at, now);
          WriteVerdict(out, "verdict", revision.verdict);
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
    WritePose(out, "T_a_b", answer.T_a_b);
    WriteMatrix(out, "covariance", answer.covariance);
    WriteSigmas(out, answer.covariance);
    WriteVerdict(out, "verdict", answer.verdict);
  });
}

std::string WriteStatus(const StatusAnswer& answer, Stamp now) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("version", answer.version);
    out.Text("now", ToIso(now));
    out.Integer("uptime_ns", answer.uptime_ns);
    out.Integer("jobs_waiting", answer.jobs_waiting);
    WriteRobotRows(out, answer.robots, now);
  });
}

std::string WriteDue(const std::vector<DueAnswer>& robots, std::int64_t max_age_ns, Stamp now) {
  const auto write_row = [&](JsonWriter& out, const DueAnswer& robot) {
    out.Text("robot", robot.robot.str());
    WriteStamp(out, "calibrated_at", robot.calibrated_at);
    WriteAge(out, robot.calibrated_at, now);
    out.Flag("overdue", !robot.calibrated_at || now.ns - robot.calibrated_at->ns > max_age_ns);
    WriteVerdict(out, "verdict", robot.verdict);
  };
  return WriteObject([&](JsonWriter& out) {
    out.Integer("max_age_ns", max_age_ns);
    out.Text("now", ToIso(now));
    out.List("robots", [&] {
      for (const DueAnswer& robot : robots) out.Object([&] { write_row(out, robot); });
    });
  });
}

std::string WriteHealth(const HealthAnswer& answer, Stamp now) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("state", answer.problem ? "failing" : "ok");
    out.Text("version", answer.version);
    out.Integer("protocol", answer.protocol);
    out.Integer("schema", answer.schema);
    out.Integer("uptime_ns", answer.uptime_ns);
    out.Integer("disk_free_bytes", answer.disk_free_bytes);
    out.Text("now", ToIso(now));
    if (!answer.problem) return out.Null("problem");
    out.Object("problem", [&] { WriteErrorMembers(out, *answer.problem); });
  });
}

std::string WriteError(const Error& error) {
  return WriteObject(
      [&](JsonWriter& out) { out.Object("error", [&] { WriteErrorMembers(out, error); }); });
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

std::string WriteSessionEvent(const SessionAnswer& session) {
  return WriteObject([&](JsonWriter& out) { WriteSessionMembers(out, session); });
}

std::string WriteEdgeEvent(const Edge& edge, std::int64_t jobs_waiting, std::int64_t jobs_total) {
  return WriteObject([&](JsonWriter& out) {
    out.Object("edge", [&] {
      WriteEdgeSummary(out, edge);
      WriteResidual(out, nullptr);
    });
    out.Integer("jobs_waiting", jobs_waiting);
    out.Integer("jobs_total", jobs_total);
  });
}

std::string WriteGraphEvent(const RobotId& robot, std::int64_t edges, const GraphSolution& solution) {
  std::int64_t known = 0;
  for (const SensorPose& pose : solution.poses) known += pose.known ? 1 : 0;
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    out.Integer("edges", edges);
    out.Integer("sensors", static_cast<std::int64_t>(solution.poses.size()));
    out.Integer("sensors_known", known);
    out.Flag("converged", solution.converged);
    out.Number("cost", solution.cost);
    out.Integer("dof", solution.dof);
    WriteGlobalErrors(out, solution.before, solution.after);
  });
}

std::string WriteRevisionEvent(const Revision& revision) {
  return WriteObject([&](JsonWriter& out) {
    WriteRevisionMembers(out, revision);
    WriteVerdict(out, "verdict", revision.verdict);
  });
}

std::string WritePublishedEvent(const RobotId& robot, int revision, const std::string& path) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    out.Integer("revision", revision);
    out.Text("path", path);
  });
}

}  // namespace rigcal::formats
