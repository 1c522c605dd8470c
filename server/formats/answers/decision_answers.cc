#include "server/formats/answers/answer_rows.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

void WriteDecision(JsonWriter& out, const std::string& name, const std::optional<Decision>& decision) {
  if (!decision) return out.Null(name);
  out.Object(name, [&] {
    out.Integer("revision", decision->revision);
    out.Text("how", decision->how);
    WriteWord(out, decision->word);
  });
}

}  // namespace

void WriteApproval(JsonWriter& out, const Approval& approval) {
  out.Text("state", NameOf(approval.state));
  WriteDecision(out, "decision", approval.decision);
  WriteDecision(out, "in_use", approval.in_use);
  if (!approval.cause.empty()) out.Text("cause", approval.cause);
}

void WriteRuns(JsonWriter& out, const std::optional<Runs>& runs) {
  if (!runs) return out.Null("runs");
  out.Object("runs", [&] {
    runs->revision > 0 ? out.Integer("revision", runs->revision) : out.Null("revision");
    if (!runs->digest.empty()) out.Text("digest", runs->digest.str());
    runs->trouble.empty() ? out.Null("trouble") : out.Text("trouble", runs->trouble);
  });
}

std::string WriteDecided(const Revision& revision, const Approval& approval) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", revision.robot.str());
    out.Integer("revision", revision.number);
    out.Flag("revision_follows", false);
    WriteVerdict(out, "verdict", revision.verdict);
    WriteApproval(out, approval);
  });
}

}  // namespace rigcal::formats
