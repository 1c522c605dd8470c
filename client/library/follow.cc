// A robot's calibration in use: what DDS announces says when to look, `show` says what there is, as for `rigcal agent`
// and `rigcal tf`.
#include <climits>

#include "client/change/agent_file.h"
#include "client/exchange/may_leave.h"
#include "client/library/handle.h"
#include "idl/convert.h"

namespace rigcal::client {
namespace {

using FollowClock = std::chrono::steady_clock;

constexpr std::chrono::seconds kLookAgain(2);  // what failed is tried again after so long

std::chrono::milliseconds Until(FollowClock::time_point time) {
  return std::max(std::chrono::ceil<std::chrono::milliseconds>(time - FollowClock::now()),
                  std::chrono::milliseconds(0));
}

}  // namespace
}  // namespace rigcal::client

using namespace rigcal;          // NOLINT: what follows is C's, in no namespace
using namespace rigcal::client;  // NOLINT

struct rigcal_follower {
  rigcal_client* client;
  std::string robot;
  wire::Reader<rigcal_wire_Calibration> announced;
  wire::WaitSet waitset;
  std::optional<FollowClock::time_point> look_at = FollowClock::now();
  std::optional<std::string> told = {};  // the digest; empty: that none is in use

  std::string digest = {}, reference = {};  // that the calibration told last points to
  std::vector<std::string> names = {};
  std::vector<rigcal_sensor> sensors = {};

  // Waits for an announcement, or until a look is due, but not beyond `deadline`.
  Status Await(FollowClock::time_point deadline) {
    RIGCAL_TRY(waitset.Wait(Until(look_at ? std::min(*look_at, deadline) : deadline)));
    RIGCAL_ASSIGN(const bool any, announced.TakeHint(INT_MAX));
    if (any) look_at = FollowClock::now();
    return {};
  }

  Result<Document> Show(std::int64_t revision) {
    std::vector<Field> parameters = {{"robot", robot}};
    if (revision > 0) parameters.emplace_back("revision", revision);
    RIGCAL_ASSIGN(client->text, client->connection->Ask("show", JsonObject(parameters), client->timeout));
    return Document::Parse(client->text, "the server's answer to 'show'");
  }

  // True: it is another than was told last.
  Result<bool> Look(rigcal_calibration& calibration) {
    look_at = FollowClock::now() + kLookAgain;
    RIGCAL_ASSIGN(Document shown, Show(0));
    const auto in_use = RevisionInUse(shown);
    if (in_use && in_use != shown["revision"].Integer()) {
      RIGCAL_ASSIGN(shown, Show(*in_use));
    }
    look_at.reset();
    std::string now = in_use ? shown["digest"].Text() : "";
    if (told == now) return false;
    told = std::move(now);
    Keep(in_use.value_or(0), in_use ? shown : Document(), calibration);
    return true;
  }

  void Keep(std::int64_t revision, const Document& shown, rigcal_calibration& calibration) {
    digest = *told;
    reference = shown["document"]["reference"].Text();
    const std::vector<Document> rows = shown["document"]["sensors"].Items();
    names.clear();
    sensors.clear();
    for (const Document& row : rows) names.push_back(row["id"].Text());
    for (std::size_t i = 0; i < rows.size(); ++i)
      sensors.push_back({names[i].c_str(), PoseOf(rows[i]["T_ref_sensor"], rows[i]["covariance"])});
    client->text = revision > 0 ? std::string(DocumentIn(client->text)) : "null";
    calibration = {revision, digest.c_str(), reference.c_str(), sensors.size(), sensors.data()};
  }

  Result<bool> Next(std::chrono::milliseconds timeout, rigcal_calibration& calibration) {
    const auto deadline = FollowClock::now() + timeout;
    do {
      RIGCAL_TRY(Await(deadline));
      if (!look_at || FollowClock::now() < *look_at) continue;
      RIGCAL_ASSIGN(const bool is_news, Look(calibration));
      if (is_news) return true;
    } while (FollowClock::now() < deadline);
    return false;
  }
};

extern "C" {

rigcal_follower* rigcal_follow(rigcal_client* client, const char* robot) {
  rigcal_follower* follower = nullptr;
  (void)Guarded(*client, [&]() -> Status {
    RIGCAL_ASSIGN(const RobotId id, RobotId::Parse(TextOf(robot)));
    RIGCAL_ASSIGN(auto announced,
                  wire::Reader<rigcal_wire_Calibration>::Open(*client->participant, {wire::RobotPartition(id)}));
    RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(*client->participant));
    RIGCAL_TRY(waitset.Attach(announced.get()));
    follower = new rigcal_follower{client, id.str(), std::move(announced), std::move(waitset)};
    return {};
  });
  return follower;
}

int rigcal_next(rigcal_follower* follower, double timeout_s, rigcal_calibration* calibration, int* news) {
  *news = 0;
  return Guarded(*follower->client, [&]() -> Status {
    RIGCAL_ASSIGN(const bool is_news, follower->Next(MillisecondsOf(timeout_s), *calibration));
    *news = is_news ? 1 : 0;
    return {};
  });
}

void rigcal_unfollow(rigcal_follower* follower) { delete follower; }

}  // extern "C"
