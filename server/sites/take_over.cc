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
Result<int> FindRevision(storage::Store& store, const formats::InUseAtCentre& one) {
  RIGCAL_ASSIGN(const auto revisions, storage::LoadRevisions(store, one.robot, 0, kRevisionsLookedAt));
  const auto same = std::find_if(revisions.begin(), revisions.end(),
                                 [&](const Revision& revision) { return revision.digest == one.digest; });
  return same == revisions.end() ? 0 : same->number;
}

std::string WhoOf(const formats::InUseAtCentre& one) { return one.who + " at the centre"; }

// With its time there: so a word is known again, and is taken over once, however the clocks differ.
std::string ReasonOf(const formats::InUseAtCentre& one) {
  constexpr std::size_t kReasonBytesMax = 400;  // of those that a word may have
  const std::string said = "said there " + ToIso(one.at);
  return one.reason.empty() || one.reason.size() > kReasonBytesMax ? said : one.reason + " (" + said + ")";
}

std::string ApprovalOf(const formats::InUseAtCentre& one, int revision) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("robot", one.robot.str());
    out.Integer("revision", revision);
    out.Text("who", WhoOf(one));
    out.Text("reason", ReasonOf(one));
  });
}

void SayOnce(std::set<Digest>& told, const formats::InUseAtCentre& one, const std::string& text) {
  constexpr std::size_t kToldMax = 100'000;
  if (told.size() < kToldMax && told.insert(one.digest).second) LogWarn("robot " + one.robot.str() + ": " + text);
}

Status TakeOverOne(storage::Store& store, const formats::InUseAtCentre& one, const GivesOrder& give,
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
  if (about && about->word.at >= one.at) return {};  // a later no of here, say
  RIGCAL_ASSIGN(const bool was_taken_over,
                storage::WasApprovedBecause(store, one.robot, revision, WhoOf(one), ReasonOf(one)));
  if (was_taken_over) return {};
  const auto done = give("approve", ApprovalOf(one, revision));
  if (done)
    LogInfo("robot " + one.robot.str() + ": revision " + std::to_string(revision) + " is in use, as at the centre");
  if (!done) SayOnce(told, one, "what is in use at the centre cannot be used here: " + Sentence(done.error()));
  return {};
}

}  // namespace

Status TakeOver(storage::Store& store, const CentreLink& link, const GivesOrder& give, std::set<Digest>& told) {
  RIGCAL_ASSIGN(const auto robots,
                storage::LoadRobotNames(store, "", static_cast<std::int64_t>(formats::kRobotsAskedMax)));
  if (robots.empty()) return {};
  RIGCAL_ASSIGN(const auto in_use, link.AskInUse(robots));
  for (const formats::InUseAtCentre& one : in_use) RIGCAL_TRY(TakeOverOne(store, one, give, told));
  return {};
}

}  // namespace rigcal::sites
