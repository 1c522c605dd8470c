#include "client/exchange/may_leave.h"

#include "client/text/table.h"
#include "client/verb.h"
#include "server/model/approval/decision.h"
#include "server/model/approval/validity.h"

namespace rigcal::client {
namespace {

RevisionState StateOf(const Document& shown) {
  if (shown.Has("state")) return RevisionStateOf(shown["state"].Text());
  const Verdict verdict{VerdictLevelOf(shown["document"]["verdict"]["level"].Text()), "", ""};
  return IsUsable(verdict) ? RevisionState::kApproved : RevisionState::kUnusable;
}

// "fail", "unknown"; else where it is in its life.
std::string WordOfState(const Document& shown, RevisionState state) {
  return state == RevisionState::kUnusable ? Plain(shown["document"]["verdict"]["level"].Text("unknown"))
                                           : WordFor(state);
}

std::string RevisionText(const Document& shown) {
  return "revision " + CountOf(shown["revision"]) + " of " + Plain(shown["robot"].Text("?"));
}

std::string WhyItStays(const Document& shown, RevisionState state) {
  if (state == RevisionState::kUnusable)
    return RevisionText(shown) + " has the verdict " + VerdictText(shown["document"]["verdict"], shown);
  return RevisionText(shown) + " is not approved: it is " + WordFor(state);
}

std::string CureOf(const Document& shown, RevisionState state, bool may_be_overruled) {
  const std::string command =
      "rigcal approve " + Plain(shown["robot"].Text("ROBOT")) + " " + CountOf(shown["revision"]) + " --reason TEXT";
  const std::string approve = state == RevisionState::kUnusable ? "" : "`" + command + "` approves it. ";
  if (may_be_overruled) return approve + "--even-if-not-approved writes it all the same.";
  return approve.empty() ? "A session that passes replaces it." : "`" + command + "` approves it.";
}

std::string WithoutStop(std::string text) {
  while (!text.empty() && text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

std::optional<std::int64_t> RevisionInUse(const Document& shown) {
  if (!shown.Has("usable")) return shown["revision"].Integer();
  return shown["usable"]["revision"].Integer();
}

Result<Leave> MayLeave(const Document& shown, bool even_if_not_approved, bool may_be_overruled) {
  const RevisionState state = StateOf(shown);
  const std::string word = WordOfState(shown, state);
  const std::string overdue = shown["overdue"].Flag() ? DriveText(shown) : "";
  if (state == RevisionState::kApproved) return Leave{word, overdue};
  if (state == RevisionState::kSuperseded) return Leave{word, RevisionText(shown) + " is not the one that is in use."};
  if (!even_if_not_approved)
    return Fail(ErrorCode::kConflict, WithoutStop(WhyItStays(shown, state)), CureOf(shown, state, may_be_overruled));
  return Leave{word + ", not approved", WithoutStop(WhyItStays(shown, state)) + "."};
}

}  // namespace rigcal::client
