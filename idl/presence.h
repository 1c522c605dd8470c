// Who serves on a domain and tag: each rigcald tells its name and its state in the user data of its participants, which
// discovery brings to everybody there before anything else.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "idl/dds.h"
#include "server/base/stamp.h"

namespace rigcal::wire {

enum class ServerState {
  kClaims,  // it starts, and looks whether another serves
  kServes,
  kWaits,  // for the one that serves to go away
};

struct ServerName {
  std::string id;  // differs for every start
  ServerState state = ServerState::kServes;
  Stamp since;       // when it claimed its place
  std::string host;  // empty: an older rigcald, which does not tell its name
  int pid = 0;
  std::string folder;      // of its data
  std::string store = {};  // that it shares with other servers; empty: it has its store for itself
};

// User data of a participant.
[[nodiscard]] std::string WriteServerName(const ServerName& name);
// nullopt: no rigcald's. Unknown members are passed over; what is not printable, or not there, is left empty.
[[nodiscard]] std::optional<ServerName> ReadServerName(std::string_view user_data);
// "rigcald on bench-pc (process 4711, data in /srv/rigcal)"
[[nodiscard]] std::string TextOf(const ServerName& name);

// What discovery knows. One thread.
class ServerList {
 public:
  [[nodiscard]] static Result<ServerList> Open(const Participant& participant);
  // Each rigcald once, of any state, also those that tell no name; sorted by id. A process that was killed is listed
  // for the 3 s of its lease to whoever met it; who came later never hears of it.
  [[nodiscard]] Result<std::vector<ServerName>> Load();

 private:
  ServerList(Entity participants, Entity subscriptions)
      : participants_(std::move(participants)), subscriptions_(std::move(subscriptions)) {}
  Entity participants_, subscriptions_;  // readers of the topics that discovery fills
};

}  // namespace rigcal::wire
