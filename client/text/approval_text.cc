#include "client/text/approval_text.h"

#include "client/text/table.h"
#include "client/verb.h"
#include "server/base/stamp.h"
#include "server/model/approval/decision.h"

namespace rigcal::client {
namespace {

std::optional<Decision> DecisionIn(const Document& decision) {
  if (decision.IsNull()) return std::nullopt;
  Decision read;
  read.revision = static_cast<int>(decision["revision"].Integer().value_or(0));
  read.how = decision["how"].Text();
  read.word = {ParseIso(decision["at"].Text()).value_or(Stamp{}), decision["who"].Text("?"), decision["reason"].Text()};
  return read;
}

std::string NumberOfUse(const Document& document) { return CountOf(document["in_use"]["revision"]); }

}  // namespace

void PrintApproval(const Document& document, std::ostream& out) {
  if (!document.Has("state")) return;
  const Approval approval{RevisionStateOf(document["state"].Text()), DecisionIn(document["decision"]),
                          DecisionIn(document["in_use"]), document["cause"].Text()};
  const std::string text = ApprovalText(RobotId(document["robot"].Text("?")),
                                        static_cast<int>(document["revision"].Integer().value_or(0)), approval);
  if (!text.empty()) out << "         " << Plain(text) << '\n';
  if (const std::string runs = RunsText(document); !runs.empty()) out << "         " << runs << '\n';
}

std::string RunsText(const Document& document) { return Plain(document["runs"]["trouble"].Text()); }

std::string InUseText(const Document& row) {
  const RevisionState state = RevisionStateOf(row["state"].Text());
  if (!row.Has("state") || state == RevisionState::kUnusable || state == RevisionState::kApproved) return "";
  const Document usable = row["usable"]["revision"];
  const std::string used = usable.Integer() ? "revision " + CountOf(usable) + " is in use." : "none is in use.";
  return (state == RevisionState::kCandidate ? "A candidate: " : "Not in use: ") + used;
}

std::string DecidedText(const Document& done) {
  const auto decision = DecisionIn(done["decision"]);
  const std::string number = CountOf(done["revision"]), robot = done["robot"].Text("?");
  const std::string who = decision ? decision->word.who : "?";
  const std::string reason = decision && !decision->word.reason.empty() ? ": " + decision->word.reason : "";
  const std::string how = decision ? decision->how : "";
  std::string text = how == "rolled_back"
                         ? "Robot " + robot + " was rolled back to revision " + number + " by " + who + reason
                         : "Revision " + number + " of " + robot + " was " + how + " by " + who + reason;
  text += NumberOfUse(done) == number ? ". It is in use now."
          : done["in_use"].IsNull()   ? ". No calibration of " + robot + " is in use now."
                                      : ". Revision " + NumberOfUse(done) + " is in use.";
  return Plain(text);
}

}  // namespace rigcal::client
