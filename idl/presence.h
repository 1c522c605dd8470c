// Who serves on a domain and tag: each rigcald tells its name and its state in the user data of its participants, which
// discovery brings to everybody there before anything else.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "idl/dds.h"
#include "idl/security.h"
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
  std::string host;  // empty: with an identity, which tells nobody; and of an older rigcald, whose `since` is 0
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

// What discovery knows. With identities those are servers whom their permissions let write in kServersPartition: what
// others say of themselves counts for nothing. One thread.
class ServerList {
 public:
  [[nodiscard]] static Result<ServerList> Open(const Participant& participant);
  // Each rigcald once, of any state, also those that tell no name; sorted by id. A process that was killed is listed
  // for the 3 s of its lease to whoever met it; who came later never hears of it.
  [[nodiscard]] Result<std::vector<ServerName>> Load();

 private:
  ServerList(Entity participants, Entity subscriptions, std::optional<Reader<rigcal_wire_Event>> proof)
      : participants_(std::move(participants)), subscriptions_(std::move(subscriptions)), proof_(std::move(proof)) {}
  Entity participants_, subscriptions_;             // readers of the topics that discovery fills
  std::optional<Reader<rigcal_wire_Event>> proof_;  // with identities: matched by servers alone
};

// Shows, with identities, that this process is a server, for as long as it lives; null without.
[[nodiscard]] Result<std::optional<Writer<rigcal_wire_Event>>> ProveServer(const Participant& participant);

}  // namespace rigcal::wire
