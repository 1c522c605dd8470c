#include "server/sites/take_over.h"

#include <algorithm>

#include "server/base/log.h"
#include "server/formats/json/json_writer.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"

namespace rigcal::sites {
namespace {

constexpr std::int64_t kRevisionsLookedAt = 200;  // the newest

// The newest of the robot with this document; 0: there is none.
Result<int> FindRevision(storage::Store& store, const formats::WordAtCentre& one) {
  RIGCAL_ASSIGN(const auto revisions, storage::LoadRevisions(store, one.robot, 0, kRevisionsLookedAt));
  const auto same = std::find_if(revisions.begin(), revisions.end(),
                                 [&](const Revision& revision) { return revision.digest == one.digest; });
  return same == revisions.end() ? 0 : same->number;
}

std::string WhoOf(const formats::WordAtCentre& one) { return one.who + " at the centre"; }

// With its time there: so a word is known again, and is taken over once, however the clocks differ.
std::string ReasonOf(const formats::WordAtCentre& one) {
  constexpr std::size_t kReasonBytesMax = 400;  // of those that a word may have
  const std::string said = "said there " + ToIso(one.at);
  return one.reason.empty() || one.reason.size() > kReasonBytesMax ? said : one.reason + " (" + said + ")";
}

std::string OrderOf(const formats::WordAtCentre& one, int revision) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("robot", one.robot.str());
    out.Integer("revision", revision);
    out.Text("who", WhoOf(one));
    out.Text("reason", ReasonOf(one));
  });
}

void SayOnce(std::set<Digest>& told, const formats::WordAtCentre& one, const std::string& text) {
  constexpr std::size_t kToldMax = 100'000;
  if (told.size() < kToldMax && told.insert(one.digest).second) LogWarn("robot " + one.robot.str() + ": " + text);
}

// Whether somebody here said another thing of it after that, or has taken it over before.
Result<bool> IsSettledHere(storage::Store& store, const formats::WordAtCentre& one, int revision,
                           const std::optional<Decision>& about) {
  const bool is_of_person = about && about->word.who != kPolicyWho;
  if (about && about->word.at >= one.at && (is_of_person || one.how != "rejected")) return true;
  return storage::WasDecidedBecause(store, one.robot, revision, WhoOf(one), ReasonOf(one));
}

void Say(const GivesOrder& give, const std::string& verb, const formats::WordAtCentre& one, int revision,
         std::set<Digest>& told) {
  const auto done = give(verb, OrderOf(one, revision));
  const std::string is_so = one.how == "rejected" ? " is rejected" : " is in use";
  if (done)
    LogInfo("robot " + one.robot.str() + ": revision " + std::to_string(revision) + is_so + ", as at the centre");
  if (!done) SayOnce(told, one, "what was decided at the centre cannot be decided here: " + Sentence(done.error()));
}

Status TakeOverInUse(storage::Store& store, const formats::WordAtCentre& one, const GivesOrder& give,
                     std::set<Digest>& told) {
  RIGCAL_ASSIGN(const auto here, storage::LoadInUse(store, one.robot));
  if (here && here->word.at >= one.at) return {};
  RIGCAL_ASSIGN(const int revision, FindRevision(store, one));
  if (here && here->revision == revision) return {};
  if (revision == 0) {
    SayOnce(told, one,
            "what is in use at the centre was not worked out here; it is taken over once it is, which takes the same "
            "measurements, version, policies and rig models");
    return {};
  }
  RIGCAL_ASSIGN(const auto about, storage::LoadDecision(store, one.robot, revision));
  RIGCAL_ASSIGN(const bool is_settled, IsSettledHere(store, one, revision, about));
  if (is_settled) return {};
  // As the no that it was: else the policy here would have its way with what was rolled back.
  RIGCAL_ASSIGN(const bool was_approved, storage::WasApproved(store, one.robot, revision));
  const bool goes_back = one.how == "rolled_back" && was_approved && (!about || about->how != "rejected");
  Say(give, goes_back ? "rollback" : "approve", one, revision, told);
  return {};
}

// What the policy here decided is no answer to a person's no, whenever that was.
Status TakeOverRejection(storage::Store& store, const formats::WordAtCentre& one, const GivesOrder& give,
                         std::set<Digest>& told) {
  RIGCAL_ASSIGN(const int revision, FindRevision(store, one));
  if (revision == 0) return {};
  RIGCAL_ASSIGN(const auto about, storage::LoadDecision(store, one.robot, revision));
  if (about && about->how == "rejected") return {};
  RIGCAL_ASSIGN(const bool is_settled, IsSettledHere(store, one, revision, about));
  if (!is_settled) Say(give, "reject", one, revision, told);
  return {};
}

}  // namespace

Status TakeOver(storage::Store& store, const CentreLink& link, const GivesOrder& give, std::set<Digest>& told) {
  RIGCAL_ASSIGN(const auto robots,
                storage::LoadRobotNames(store, "", static_cast<std::int64_t>(formats::kRobotsAskedMax)));
  if (robots.empty()) return {};
  RIGCAL_ASSIGN(const formats::WordsAtCentre words, link.AskInUse(robots));
  for (const formats::WordAtCentre& one : words.rejected) RIGCAL_TRY(TakeOverRejection(store, one, give, told));
  for (const formats::WordAtCentre& one : words.in_use) RIGCAL_TRY(TakeOverInUse(store, one, give, told));
  return {};
}

}  // namespace rigcal::sites
