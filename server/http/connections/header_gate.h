// Holds a connection until the head of its request is whole: a client that says nothing, or a byte now and then, takes
// a descriptor and no worker of civetweb, which reads a head with a thread per connection and has no other way.
#pragma once

#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <deque>
#include <list>
#include <mutex>
#include <string_view>
#include <thread>
#include <unordered_map>

#include "server/base/files/file_descriptor.h"
#include "server/http/connections/client_address.h"
#include "server/http/served.h"

namespace rigcal::http {

// What civetweb would do with these first bytes of a request: read on, or answer (also where it refuses them).
enum class Head { kPartial, kWhole };
constexpr std::size_t kHeadBytesMax = 16 << 10;  // of civetweb: beyond them it refuses
// kWhole once the head ends, or where civetweb refuses it: too long, or with a control character.
[[nodiscard]] Head JudgeHead(std::string_view bytes);

// At most limits::kHttpWaitingMax connections wait, and kHttpWaitingOfPeerMax of one network (client_address.h): one
// more of it makes its oldest go, and one more of all the oldest of the network that has most. What passed is handed on
// while a thread of civetweb is free for it (served.h); as many wait for that, and there the newest of the same
// networks go. Any thread.
class HeaderGate {
 public:
  // `head_within`: of a whole head, however it trickles. `served_at_once`: threads of civetweb. `has_tls`: what is held
  // until it is whole is the beginning of the handshake, as the head cannot be seen; who speaks plain HTTP is told so
  // and leaves.
  HeaderGate(std::chrono::milliseconds head_within, std::size_t served_at_once, bool has_tls = false);
  ~HeaderGate();
  HeaderGate(const HeaderGate&) = delete;
  HeaderGate& operator=(const HeaderGate&) = delete;

  // From now on accept() on the calling thread gives what passed the gate. The gate outlives the thread.
  void GuardThisThread();
  // A connection whose head is whole, unread; -1 with EAGAIN if there is none yet. Takes one that came to `listener`.
  // Where there is no memory to keep them, all that wait are let go.
  [[nodiscard]] int Accept(int listener, sockaddr* address, socklen_t* size);
  // civetweb has read what this one asks: from now on only who takes no answer is put out.
  void Heard(const Peer& peer);
  // civetweb is about to close a connection that Accept() gave it.
  void Ended(const Peer& peer);

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Waiting {
    FileDescriptor connection;
    Peer peer;
    Time leaves_at;
  };
  struct Ready {
    FileDescriptor connection;
    Peer peer;
  };
  using Queue = std::list<Waiting>;  // the oldest first

  void Run();
  [[nodiscard]] int PatienceMs();
  enum class Seen { kPartial, kWhole, kGone };
  // What has come so far, left where it is. kGone too of a client that was sent away.
  [[nodiscard]] Seen LookAt(int connection, bool client_is_done) const;
  [[nodiscard]] Seen Judge(int connection, std::string_view bytes) const;
  void Look(int connection, bool client_is_done);
  void LeaveTheLate();
  void Came(FileDescriptor connection);
  void TakeIn(FileDescriptor connection, const Peer& peer);
  void MakeRoomFor(const std::string& address);
  void Pass(FileDescriptor connection, const Peer& peer);
  void MakeRoomAmongReady();
  void Leave(Queue::iterator one);
  void LetAllGo() noexcept;
  [[nodiscard]] int AcceptNext(int listener, sockaddr* address, socklen_t* size);
  void LookAround();
  // Which of ready_ may be handed on; its end if none.
  [[nodiscard]] std::deque<Ready>::iterator NextReady();
  [[nodiscard]] FileDescriptor Next();
  void HelpTheReady();
  void Knock() const;

  const std::chrono::milliseconds head_within_;
  const bool has_tls_;
  FileDescriptor poll_, wake_;
  std::mutex mutex_;
  Queue waiting_;
  std::unordered_map<int, Queue::iterator> by_descriptor_;
  std::deque<Ready> ready_;
  NetworkCounts of_waiting_, of_ready_;
  Served served_;
  Time looked_at_;  // who is served, for one that could go
  sockaddr_storage listens_at_{};
  socklen_t listens_at_size_ = 0;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace rigcal::http
