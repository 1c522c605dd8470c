#include "server/formats/answers/recomputation.h"

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

void WriteRun(JsonWriter& out, const RecomputationRun& run) {
  out.Integer("run", run.number);
  out.Text("scope", run.scope);
  run.subject.empty() ? out.Null("subject") : out.Text("subject", run.subject);
  out.Text("scope_text", ScopeText(run));
  out.Text("cause", CauseText(run));
  out.Text("who", run.who);
  WriteStamp(out, "asked_at", run.asked_at);
  out.Text("software", run.software);
  out.Text("estimator", run.estimator);
}

void WriteProgress(JsonWriter& out, const RecomputationProgress& progress) {
  out.Flag("done", progress.is_done());
  out.Object("sessions", [&] {
    out.Integer("total", progress.sessions);
    out.Integer("done", progress.sessions_done());
    out.Integer("computed", progress.computed);
    out.Integer("same", progress.same);
    out.Integer("kept", progress.kept);
    out.Integer("failed", progress.failed_sessions);
    if (progress.older > 0) out.Integer("older", progress.older);
  });
  out.Object("robots_count", [&] {
    out.Integer("total", progress.robots);
    out.Integer("done", progress.robots_done());
    out.Integer("changed", progress.changed);
    out.Integer("unchanged", progress.unchanged);
    out.Integer("failed", progress.failed_robots);
  });
}

void WritePoseChange(JsonWriter& out, const PoseChange& change) {
  const bool moved = change.how == "moved";
  out.Text("sensor", change.sensor.str());
  out.Text("how", change.how);
  moved ? out.Number("moved_m", change.moved_m) : out.Null("moved_m");
  moved ? out.Number("turned_rad", change.turned_rad) : out.Null("turned_rad");
  change.sigma_ratio ? out.Number("sigmas", *change.sigma_ratio) : out.Null("sigmas");
}

void WriteRecomputedRobot(JsonWriter& out, const RecomputedRobotRow& row) {
  const RecomputedRobot& done = row.done;
  out.Text("robot", done.robot.str());
  out.Text("how", NameOf(done.how));
  WriteRevisionNumber(out, done.revision);
  done.against > 0 ? out.Integer("against", done.against) : out.Null("against");
  done.revision > 0 ? out.Text("state", NameOf(row.state)) : out.Null("state");
  done.revision > 0 ? out.Text("verdict", row.verdict) : out.Null("verdict");
  done.why.empty() ? out.Null("why") : out.Text("why", done.why);
  out.List("changes", [&] {
    for (const PoseChange& change : done.changes) out.Object([&] { WritePoseChange(out, change); });
  });
}

void WriteSessionLeft(JsonWriter& out, const SessionLeft& left) {
  out.Text("robot", left.robot.str());
  out.Text("session", left.session.str());
  out.Text("how", NameOf(left.how));
  out.Text("why", left.why);
}

}  // namespace

std::string WriteRecomputation(const RecomputationAnswer& answer) {
  return WriteObject([&](JsonWriter& out) {
    WriteRun(out, answer.run);
    WriteProgress(out, answer.progress);
    if (answer.is_new) out.Flag("new", *answer.is_new);
    out.List("robots", [&] {
      for (const RecomputedRobotRow& row : answer.robots) out.Object([&] { WriteRecomputedRobot(out, row); });
    });
    out.List("sessions_left", [&] {
      for (const SessionLeft& left : answer.left) out.Object([&] { WriteSessionLeft(out, left); });
    });
  });
}

}  // namespace rigcal::formats
