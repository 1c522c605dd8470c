#include "server/http/served.h"

#include <linux/tcp.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <vector>

namespace rigcal::http {
namespace {

constexpr std::chrono::seconds kTakesWithin{1};

std::string NameOf(const Peer& peer) { return peer.address + " " + std::to_string(peer.port); }

bool IsOf(int connection, const Peer& peer) {
  const auto now = PeerOf(connection);
  return now && now->address == peer.address && now->port == peer.port;
}

bool HasUntaken(int connection) {
  int bytes = 0;
  return ioctl(connection, TIOCOUTQ, &bytes) == 0 && bytes > 0;
}

// Of an answer, so far; 0 where the system does not tell.
std::uint64_t BytesTaken(int connection) {
  tcp_info info{};
  socklen_t size = sizeof info;
  return getsockopt(connection, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 ? info.tcpi_bytes_acked : 0;
}

}  // namespace

std::optional<Peer> PeerOf(int connection) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  std::array<char, NI_MAXHOST> text{};
  if (getpeername(connection, any, &size) != 0) return std::nullopt;
  if (getnameinfo(any, size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) != 0) return std::nullopt;
  const in_port_t port = address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&address)->sin6_port
                                                       : reinterpret_cast<sockaddr_in*>(&address)->sin_port;
  return Peer{text.data(), ntohs(port)};
}

bool Served::HasRoomFor(const std::string& address) const {
  return by_peer_.size() < at_once_ && of_network_.Of(address) < std::max<std::size_t>(1, at_once_ * 3 / 4);
}

void Served::Began(const Peer& peer, int connection, Time now) {
  Ended(peer);
  by_peer_[NameOf(peer)] = {peer, connection, 0, now, false, false};
  of_network_.Add(peer.address);
}

void Served::Heard(const Peer& peer) {
  const auto found = by_peer_.find(NameOf(peer));
  if (found == by_peer_.end() || found->second.is_heard) return;
  found->second.is_heard = true;
  found->second.took_at = std::chrono::steady_clock::now();
}

void Served::Ended(const Peer& peer) {
  const auto found = by_peer_.find(NameOf(peer));
  if (found == by_peer_.end()) return;
  of_network_.Remove(peer.address);
  by_peer_.erase(found);
}

void Served::ForgetClosed() {
  std::vector<Peer> closed;
  for (const auto& [name, one] : by_peer_)
    if (!IsOf(one.connection, one.peer)) closed.push_back(one.peer);
  for (const Peer& peer : closed) Ended(peer);
}

bool Served::IsDeaf(One& one, Time now) {
  if (one.is_shut || !IsOf(one.connection, one.peer)) return false;
  if (!one.is_heard) return now - one.took_at >= kTakesWithin;
  if (!HasUntaken(one.connection)) return false;
  const std::uint64_t taken = BytesTaken(one.connection);
  if (taken != one.taken_bytes) one.taken_bytes = taken, one.took_at = now;
  return now - one.took_at >= kTakesWithin;
}

void Served::ShutDeaf(std::size_t count, Time now) {
  std::vector<One*> deaf;
  for (auto& [name, one] : by_peer_)
    if (IsDeaf(one, now)) deaf.push_back(&one);
  std::sort(deaf.begin(), deaf.end(), [](const One* a, const One* b) { return a->took_at < b->took_at; });
  deaf.resize(std::min(deaf.size(), count));
  for (One* one : deaf) one->is_shut = shutdown(one->connection, SHUT_RDWR) == 0;
}

}  // namespace rigcal::http
