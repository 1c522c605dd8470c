#include "server/http/connections/header_gate.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "server/base/limits.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/http/tls/tls_hello.h"

namespace {
thread_local rigcal::http::HeaderGate* gate_of_this_thread = nullptr;
}

// Found by libcivetweb before the C library's own, as a symbol of the executable; the same wherever there is no gate.
extern "C" int accept(int listener, sockaddr* address, socklen_t* size) {
  if (gate_of_this_thread != nullptr) return gate_of_this_thread->Accept(listener, address, size);
  return accept4(listener, address, size, 0);
}

namespace rigcal::http {
namespace {

constexpr int kLookAgainMs = 200;  // at those who wait for a thread: a knock was lost, or somebody is deaf

bool IsMalformed(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x80 && c != '\r' && c != '\n' && std::isprint(byte) == 0;
}

// What came is taken first: a connection that is closed over unread bytes loses the answer.
void SendAway(int connection) {
  std::array<char, kHeadBytesMax> ignored;
  (void)!recv(connection, ignored.data(), ignored.size(), MSG_DONTWAIT);
  const std::string answer = AnswerToPlainHttp();
  (void)!send(connection, answer.data(), answer.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

void Ring(const FileDescriptor& wake) { static_cast<void>(eventfd_write(wake.get(), 1)); }

}  // namespace

Head JudgeHead(std::string_view bytes) {
  const bool ends = bytes.find("\r\n\r\n") != std::string_view::npos || bytes.find("\n\n") != std::string_view::npos;
  const bool refused = bytes.size() >= kHeadBytesMax || std::any_of(bytes.begin(), bytes.end(), IsMalformed);
  return ends || refused ? Head::kWhole : Head::kPartial;
}

HeaderGate::Seen HeaderGate::Judge(int connection, std::string_view bytes) const {
  if (!has_tls_) return JudgeHead(bytes) == Head::kWhole ? Seen::kWhole : Seen::kPartial;
  const Hello hello = JudgeHello(bytes);
  if (hello == Hello::kHello) return Seen::kWhole;
  if (hello == Hello::kPartial || JudgeHead(bytes) == Head::kPartial) return Seen::kPartial;
  SendAway(connection);
  return Seen::kGone;
}

HeaderGate::Seen HeaderGate::LookAt(int connection, bool client_is_done) const {
  std::array<char, kHeadBytesMax> bytes;
  const ssize_t got = recv(connection, bytes.data(), bytes.size(), MSG_PEEK | MSG_DONTWAIT);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return Seen::kPartial;
  if (got <= 0) return Seen::kGone;
  const Seen seen = Judge(connection, {bytes.data(), static_cast<std::size_t>(got)});
  return seen == Seen::kPartial && client_is_done ? Seen::kGone : seen;
}

HeaderGate::HeaderGate(std::chrono::milliseconds head_within, std::size_t served_at_once, bool has_tls)
    : head_within_(head_within),
      has_tls_(has_tls),
      poll_(epoll_create1(EPOLL_CLOEXEC)),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      served_(served_at_once) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = wake_.get();
  epoll_ctl(poll_.get(), EPOLL_CTL_ADD, wake_.get(), &event);
  thread_ = std::thread([this] { Run(); });
}

HeaderGate::~HeaderGate() {
  stopping_ = true;
  Ring(wake_);
  thread_.join();
}

void HeaderGate::GuardThisThread() { gate_of_this_thread = this; }

void HeaderGate::Leave(Queue::iterator one) {
  by_descriptor_.erase(one->connection.get());
  of_waiting_.Remove(one->peer.address);
  waiting_.erase(one);  // closed, and so forgotten by epoll
}

void HeaderGate::MakeRoomFor(const std::string& address) {
  const auto leave_oldest_of = [this](const std::string& network) {
    Leave(std::find_if(waiting_.begin(), waiting_.end(),
                       [&](const Waiting& one) { return NetworkOf(one.peer.address) == network; }));
  };
  if (of_waiting_.Of(address) >= limits::kHttpWaitingOfPeerMax) leave_oldest_of(NetworkOf(address));
  if (waiting_.size() >= limits::kHttpWaitingMax) leave_oldest_of(of_waiting_.Largest());
}

// Epoll tells of what has come already as well.
void HeaderGate::TakeIn(FileDescriptor connection, const Peer& peer) {
  MakeRoomFor(peer.address);
  const int descriptor = connection.get();
  if (waiting_.empty()) Ring(wake_);  // there is a deadline now
  waiting_.push_back({std::move(connection), peer, std::chrono::steady_clock::now() + head_within_});
  by_descriptor_[descriptor] = std::prev(waiting_.end());
  of_waiting_.Add(peer.address);
  epoll_event event{};
  event.events = EPOLLIN | EPOLLRDHUP | EPOLLET;
  event.data.fd = descriptor;
  if (epoll_ctl(poll_.get(), EPOLL_CTL_ADD, descriptor, &event) != 0) Leave(std::prev(waiting_.end()));
}

void HeaderGate::Came(FileDescriptor connection) {
  const auto peer = PeerOf(connection.get());
  if (!peer) return;
  const Seen seen = ready_.empty() ? LookAt(connection.get(), false) : Seen::kPartial;
  if (seen == Seen::kWhole) return Pass(std::move(connection), *peer);
  if (seen == Seen::kPartial) TakeIn(std::move(connection), *peer);
}

void HeaderGate::MakeRoomAmongReady() {
  if (ready_.size() < limits::kHttpWaitingMax) return;
  const std::string largest = of_ready_.Largest();
  const auto newest = std::find_if(ready_.rbegin(), ready_.rend(),
                                   [&](const Ready& one) { return NetworkOf(one.peer.address) == largest; });
  of_ready_.Remove(newest->peer.address);
  ready_.erase(std::prev(newest.base()));
}

void HeaderGate::Pass(FileDescriptor connection, const Peer& peer) {
  if (of_ready_.Of(peer.address) >= limits::kHttpWaitingOfPeerMax) return;
  MakeRoomAmongReady();
  if (ready_.empty()) Ring(wake_);  // it is looked after now
  ready_.push_back({std::move(connection), peer});
  of_ready_.Add(peer.address);
}

std::deque<HeaderGate::Ready>::iterator HeaderGate::NextReady() {
  return std::find_if(ready_.begin(), ready_.end(),
                      [this](const Ready& one) { return served_.HasRoomFor(one.peer.address); });
}

FileDescriptor HeaderGate::Next() {
  const auto next = NextReady();
  if (next == ready_.end()) return FileDescriptor(-1);
  served_.Began(next->peer, next->connection.get(), std::chrono::steady_clock::now());
  of_ready_.Remove(next->peer.address);
  FileDescriptor connection = std::move(next->connection);
  ready_.erase(next);
  return connection;
}

// What was being changed is begun anew. Whoever waited comes again.
void HeaderGate::LetAllGo() noexcept {
  by_descriptor_.clear();
  waiting_.clear();
  ready_.clear();
  of_waiting_ = {};
  of_ready_ = {};
}

int HeaderGate::Accept(int listener, sockaddr* address, socklen_t* size) {
  const auto accepted = rigcal::Guarded([&]() -> Result<int> { return AcceptNext(listener, address, size); });
  if (accepted) return *accepted;
  LogError(accepted.error());
  const std::lock_guard lock(mutex_);
  LetAllGo();
  errno = EAGAIN;
  return -1;
}

int HeaderGate::AcceptNext(int listener, sockaddr* address, socklen_t* size) {
  FileDescriptor came(accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
  const bool too_many_open = came.get() < 0 && (errno == EMFILE || errno == ENFILE);
  const std::lock_guard lock(mutex_);
  if (listens_at_size_ == 0) {
    listens_at_size_ = sizeof listens_at_;
    getsockname(listener, reinterpret_cast<sockaddr*>(&listens_at_), &listens_at_size_);
  }
  if (too_many_open && !waiting_.empty()) Leave(waiting_.begin());
  if (came.get() >= 0) Came(std::move(came));
  for (FileDescriptor next = Next(); next.get() >= 0; next = Next()) {
    if (getpeername(next.get(), address, size) == 0) return next.Release();
    served_.ForgetClosed();
  }
  errno = EAGAIN;
  return -1;
}

void HeaderGate::Heard(const Peer& peer) {
  const std::lock_guard lock(mutex_);
  served_.Heard(peer);
}

void HeaderGate::Ended(const Peer& peer) {
  const std::lock_guard lock(mutex_);
  served_.Ended(peer);
  if (NextReady() != ready_.end()) Knock();
}

// A knock was lost, or nobody is free: then those go who do not take their answers.
void HeaderGate::HelpTheReady() {
  if (ready_.empty()) return;
  if (NextReady() != ready_.end()) return Knock();
  const Time now = std::chrono::steady_clock::now();
  if (now - looked_at_ < std::chrono::milliseconds(kLookAgainMs)) return;
  looked_at_ = now;
  served_.ForgetClosed();
  if (NextReady() != ready_.end()) return Knock();
  served_.ShutDeaf(ready_.size(), now);
}

// The thread that accepts sleeps until somebody comes: so somebody comes, and goes at once. Where the queue of those
// who come is full it needs no knock.
void HeaderGate::Knock() const {
  const FileDescriptor knock(socket(listens_at_.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  static_cast<void>(connect(knock.get(), reinterpret_cast<const sockaddr*>(&listens_at_), listens_at_size_));
}

void HeaderGate::Look(int connection, bool client_is_done) {
  const auto found = by_descriptor_.find(connection);
  if (found == by_descriptor_.end()) return;  // it left meanwhile
  const auto one = found->second;
  const Seen seen = LookAt(connection, client_is_done);
  if (seen == Seen::kPartial) return;
  if (seen == Seen::kWhole) {
    epoll_ctl(poll_.get(), EPOLL_CTL_DEL, connection, nullptr);
    const Peer peer = one->peer;
    FileDescriptor passes = std::move(one->connection);
    by_descriptor_.erase(found);
    of_waiting_.Remove(peer.address);
    waiting_.erase(one);
    Pass(std::move(passes), peer);
    if (NextReady() != ready_.end()) Knock();
    return;
  }
  Leave(one);
}

void HeaderGate::LeaveTheLate() {
  const Time now = std::chrono::steady_clock::now();
  while (!waiting_.empty() && waiting_.front().leaves_at <= now) Leave(waiting_.begin());
}

int HeaderGate::PatienceMs() {
  const std::lock_guard lock(mutex_);
  LeaveTheLate();
  if (!ready_.empty()) return kLookAgainMs;
  if (waiting_.empty()) return -1;
  const auto left = waiting_.front().leaves_at - std::chrono::steady_clock::now();
  return static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()) + 1;
}

void HeaderGate::LookAround() {
  std::array<epoll_event, 64> events{};
  const int count = epoll_wait(poll_.get(), events.data(), static_cast<int>(events.size()), PatienceMs());
  const std::lock_guard lock(mutex_);
  HelpTheReady();
  for (int i = 0; i < count; ++i) {
    const epoll_event& event = events[static_cast<std::size_t>(i)];
    eventfd_t rings = 0;
    if (event.data.fd == wake_.get()) eventfd_read(wake_.get(), &rings);
    Look(event.data.fd, (event.events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0);
  }
}

void HeaderGate::Run() {
  while (!stopping_) {
    const Status looked = rigcal::Guarded([this]() -> Status {
      LookAround();
      return {};
    });
    if (looked) continue;
    LogError(looked.error());
    const std::lock_guard lock(mutex_);
    LetAllGo();
  }
}

}  // namespace rigcal::http
