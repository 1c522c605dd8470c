#include "server/formats/answers/answer_rows.h"
#include "server/formats/answers/answers.h"
#include "server/formats/edges/edge_fields.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

void WriteSuperseding(JsonWriter& out, const std::optional<Superseding>& superseding) {
  if (!superseding) return out.Null("superseded_by");
  out.Object("superseded_by", [&] {
    out.Text("session", superseding->by.str());
    WriteStamp(out, "captured_at", superseding->captured_at);
    out.Text("operator", superseding->operator_name);
    WriteStanding(out, "standing", superseding->standing);
  });
}

}  // namespace

void WriteStanding(JsonWriter& out, const std::string& name, const std::optional<Standing>& standing) {
  if (!standing) return out.Null(name);
  out.Object(name, [&] {
    out.Integer("number", standing->number);
    out.Text("how", standing->how);
    WriteWord(out, standing->word);
  });
}

void WriteRetiredSensors(JsonWriter& out, const std::vector<RetiredSensor>& retired) {
  out.List("retired_sensors", [&] {
    for (const RetiredSensor& gone : retired)
      out.Object([&] {
        WriteStamp(out, "at", gone.word.at);
        out.Text("reason", gone.word.reason);
        out.Text("sensor", gone.sensor.str());
        out.Text("who", gone.word.who);
      });
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
  WriteStanding(out, "standing", session.standing);
  WriteStanding(out, "retired", session.retired);
  WriteSuperseding(out, session.superseded_by);
  WriteIds(out, "supersedes", session.supersedes);
}

void WriteEdgeRowMembers(JsonWriter& out, const Edge& edge, const EdgeResidual* residual) {
  WriteEdgeSummary(out, edge);
  WriteResidual(out, residual);
}

void WriteRevisionMembers(JsonWriter& out, const Revision& revision) {
  out.Text("robot", revision.robot.str());
  out.Integer("revision", revision.number);
  out.Text("created_at", ToIso(revision.created_at));
  out.Text("digest", revision.digest.str());
}

void WriteUsable(JsonWriter& out, const std::optional<UsableRevision>& usable) {
  if (!usable) return out.Null("usable");
  out.Object("usable", [&] {
    out.Integer("revision", usable->number);
    out.Text("created_at", ToIso(usable->created_at));
    WriteStamp(out, "calibrated_at", usable->calibrated_at);
    WriteStamp(out, "valid_until", ValidUntil(*usable));
  });
}

std::string WriteSessionEvent(const SessionAnswer& session) {
  return WriteObject([&](JsonWriter& out) { WriteSessionMembers(out, session); });
}

std::string WriteEdgeEvent(const Edge& edge, std::int64_t jobs_waiting, std::int64_t jobs_total) {
  return WriteObject([&](JsonWriter& out) {
    out.Object("edge", [&] { WriteEdgeRowMembers(out, edge, nullptr); });
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

std::string WriteRevisionEvent(const Revision& revision, const std::optional<UsableRevision>& usable) {
  return WriteObject([&](JsonWriter& out) {
    WriteRevisionMembers(out, revision);
    WriteUsable(out, usable);
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
