// One rigcald per domain and tag: two would both store what is sent, and each answer from its own store; and two of one
// store would each tell a client how far it is.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "idl/presence.h"

namespace rigcal::dds {

// The one of `others` that goes before `self`, if any. Who serves goes before who claims, then the earlier claim, then
// the smaller id: of any two that know each other exactly one goes first. Who waits goes before nobody.
[[nodiscard]] std::optional<wire::ServerName> GoesBefore(const wire::ServerName& self,
                                                         const std::vector<wire::ServerName>& others);
// Why this one does not serve; names the first and the cures.
[[nodiscard]] Error SecondServerError(const wire::ServerName& first);

// This server's place among those of its domain and tag. One thread.
class OnlyServer {
 public:
  // Claims the place, or, with `waits`, only looks. Its participant is the first that the process opens. `store`: the
  // id of a store that it shares with other servers; empty: it has its own.
  [[nodiscard]] static Result<OnlyServer> Open(const wire::ParticipantOptions& options,
                                               const std::filesystem::path& data, bool waits,
                                               const std::string& store = {});
  // Who goes before it now.
  [[nodiscard]] Result<std::optional<wire::ServerName>> Before();
  // Claims the place from now on.
  [[nodiscard]] Status Claim();
  // To be called after a claim: waits until all who are there must have been heard of, then serves. kConflict if
  // another goes before: then it waits again.
  [[nodiscard]] Status Settle();
  // The same; gives who goes before, if anybody does.
  [[nodiscard]] Result<std::optional<wire::ServerName>> TryToSettle();
  // Waits from now on, until it claims again.
  [[nodiscard]] Status GiveWay() { return Tell(wire::ServerState::kWaits); }
  // Takes part with a new participant, whose identity is read anew; the place stays. The one before goes a little
  // later, when all have met the new one. Where it fails all is as before.
  [[nodiscard]] Status Reopen(const wire::ParticipantOptions& options);
  // Whether `other` is a server of the same store.
  [[nodiscard]] bool SharesStoreWith(const wire::ServerName& other) const {
    return !self_.store.empty() && other.store == self_.store;
  }
  // `options` for the other participants of this server, so that they are known to be its own.
  [[nodiscard]] wire::ParticipantOptions Named(wire::ParticipantOptions options) const;

 private:
  // How it takes part.
  struct Presence {
    wire::Participant participant;
    wire::ServerList list;
    std::optional<wire::Writer<rigcal_wire_Event>> proof;
    [[nodiscard]] static Result<Presence> Open(const wire::ParticipantOptions& options);
  };
  OnlyServer(Presence presence, wire::ServerName self);
  [[nodiscard]] Status Tell(wire::ServerState state);

  Presence presence_;
  wire::ServerName self_;
  std::optional<Presence> before_;  // until `before_until_`
  std::chrono::steady_clock::time_point before_until_;
  std::chrono::steady_clock::time_point claimed_at_;
};

}  // namespace rigcal::dds
