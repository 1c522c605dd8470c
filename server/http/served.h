// Connections that civetweb has, one for each of its threads: nobody gets all of them, and who does not take an answer
// is put out once others wait.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/http/connections/client_address.h"

namespace rigcal::http {

// The other end of a connection, as civetweb names it.
struct Peer {
  std::string address;
  int port = 0;
};
[[nodiscard]] std::optional<Peer> PeerOf(int connection);  // nothing once it has gone

// One thread at a time.
class Served {
 public:
  using Time = std::chrono::steady_clock::time_point;
  explicit Served(std::size_t at_once) : at_once_(at_once) {}
  // One network (client_address.h) gets at most three quarters of what is served at once.
  [[nodiscard]] bool HasRoomFor(const std::string& address) const;
  // `connection` stays open until Ended(peer).
  void Began(const Peer& peer, int connection, Time now);
  // What it asks was read.
  void Heard(const Peer& peer);
  void Ended(const Peer& peer);
  // Forgets those whose descriptor is closed, or another connection's: of a malformed request civetweb does not say
  // whose it was.
  void ForgetClosed();
  // Shuts at most `count` connections that took nothing of what waits for them for a second, as it was looked at, or
  // were not heard within a second, the longest first: whoever writes to them is told. Who takes slowly keeps its
  // place. Call it several times a second.
  void ShutDeaf(std::size_t count, Time now);

 private:
  struct One {
    Peer peer;
    int connection = -1;
    std::uint64_t taken_bytes = 0;
    Time took_at;  // when that was last seen to change
    bool is_heard = false;
    bool is_shut = false;
  };
  [[nodiscard]] static bool IsDeaf(One& one, Time now);

  const std::size_t at_once_;
  std::unordered_map<std::string, One> by_peer_;  // "address port"
  NetworkCounts of_network_;
};

}  // namespace rigcal::http
