#include "server/formats/alerts/alert_body.h"

#include "server/base/digests/sha256.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::int64_t kAlertFormat = 1;

}  // namespace

AlertDraft StatusAlert(const RobotId& robot, int revision, StatusWord before, const CalibrationStatus& status,
                       Stamp at) {
  return {robot, "status", NameOf(status.word), at, [=](JsonWriter& out) {
            WriteRevisionNumber(out, revision);
            out.Text("status", NameOf(status.word));
            out.Text("before", NameOf(before));
            out.Text("why", status.why);
            out.Text("next_step", status.next_step);
          }};
}

AlertDraft DecisionAlert(const RobotId& robot, const Decision& decision) {
  return {robot, decision.how, std::to_string(decision.revision), decision.word.at, [decision](JsonWriter& out) {
            WriteRevisionNumber(out, decision.revision);
            out.Text("who", decision.word.who);
            out.Text("reason", decision.word.reason);
          }};
}

AlertDraft SessionFailedAlert(const RobotId& robot, const SessionId& session, const std::optional<Stamp>& captured_at,
                              int revision, const Verdict& verdict, Stamp at) {
  return {robot, "session_failed", session.str(), at, [=](JsonWriter& out) {
            out.Text("session", session.str());
            WriteStamp(out, "captured_at", captured_at);
            WriteRevisionNumber(out, revision);
            out.Text("why", verdict.why);
            out.Text("next_step", verdict.what_to_do);
          }};
}

Alert AlertOf(const AlertDraft& draft, std::int64_t number) {
  Alert alert{number, {}, draft.robot, draft.kind, draft.subject, draft.at, ""};
  alert.id = Sha256Of(draft.robot.str() + "\n" + draft.kind + "\n" + draft.subject + "\n" +
                      std::to_string(draft.at.ns) + "\n" + std::to_string(number));
  alert.body = WriteObject([&](JsonWriter& out) {
    out.Integer("format", kAlertFormat);
    out.Text("id", alert.id.str());
    out.Text("kind", draft.kind);
    out.Text("robot", draft.robot.str());
    WriteStamp(out, "at", draft.at);
    out.Object("data", [&] { draft.data(out); });
  });
  return alert;
}

}  // namespace rigcal::formats
