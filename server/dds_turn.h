// When this server speaks DDS. On a domain and tag one server does at a time: two would each receive all that a robot
// sends, and tell it twice how far it is. Of several servers of one store the others stand ready: they answer over HTTP
// and calibrate meanwhile, and one of them speaks when the first is gone.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "server/dds/only_server.h"
#include "server/identity_watch.h"
#include "server/service_relay.h"

namespace rigcal {

// One thread.
class DdsTurn {
 public:
  // `announces_after`: as dds::Options has it.
  using Start = std::function<Result<dds::Service>(std::chrono::milliseconds announces_after)>;
  // `relay` reaches the service while there is one; both outlive this. `participant`: as whom it takes part, its
  // identity the folder itself, without '-' before it.
  DdsTurn(dds::OnlyServer& only, ServiceRelay& relay, wire::ParticipantOptions participant, Start start);

  // Speaks from now on. The error: what `start` says, or that the list of the revoked on disk is older than the one in
  // force (IdentityWatch::CheckMayBeRead).
  [[nodiscard]] Status Speak();
  [[nodiscard]] bool Speaks() const { return service_.has_value(); }
  // To be called often: whose turn it is may have changed, or the files of its identity: who was revoked since is then
  // met no longer, as it meets all others anew, which takes a few seconds. Fails where a server of another store goes
  // before this one, which then must end: the network was cut, say, and is whole again.
  [[nodiscard]] Status Look();
  // The next Look looks at the files of its identity at once.
  void LookAtIdentity() { identity_.LookNow(); }

 private:
  [[nodiscard]] Status TakeUpIdentity();
  [[nodiscard]] Status GiveWay(const wire::ServerName& first);
  void TryToSpeak();

  dds::OnlyServer& only_;
  ServiceRelay& relay_;
  wire::ParticipantOptions participant_;
  Start start_;
  IdentityWatch identity_{participant_.identity};
  std::optional<dds::Service> service_;
  std::optional<ServiceRelay::Open> open_;  // gone before the service
  bool opens_anew_ = false;                 // those who listened before are to hear what happens meanwhile
  std::chrono::steady_clock::time_point next_try_;
};

// To be called after a claim. Nothing: the place is this server's. Another one: of the same store, and it speaks; this
// one stands ready. kConflict: one of another store has the place.
[[nodiscard]] Result<std::optional<wire::ServerName>> SettleBeside(dds::OnlyServer& only);

// Claims the place. Nothing: it is this server's; else who has it.
[[nodiscard]] Result<std::optional<wire::ServerName>> TakePlace(dds::OnlyServer& only);

}  // namespace rigcal
