// Slow, rude and many clients.
#include <atomic>
#include <chrono>
#include <future>
#include <list>
#include <thread>

#include "server/base/limits.h"
#include "server/http/connections/header_gate.h"
#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

double SecondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void ExpectAnsweredAtOnce(int port) {
  Reply reply;
  EXPECT_LT(SecondsOf([&] { reply = Get(port, "/"); }), 1.0);
  EXPECT_EQ(reply.status, 200);
}

TEST_F(HttpFixture, SixteenIdleClientsDoNotStopIt) {
  const int port = Start();
  std::list<Socket> idle;
  for (int i = 0; i < 16; ++i) ASSERT_TRUE(idle.emplace_back(port).connected());
  ExpectAnsweredAtOnce(port);
}

TEST_F(HttpFixture, HalfRequestsUpToOneBelowTheLimitDoNotStopIt) {
  const int port = Start();
  std::list<Socket> slow;
  for (std::size_t i = 0; i + 1 < limits::kHttpConnectionsMax; ++i)
    slow.emplace_back(port).Send("GET / HTTP/1.1\r\nHos");
  ExpectAnsweredAtOnce(port);
}

// Each comes back as soon as it is put out.
class HalfOpenClients {
 public:
  HalfOpenClients(int port, int count) : keeps_([this, port, count] { Keep(port, count); }) {
    begun_.get_future().wait();
  }
  ~HalfOpenClients() {
    stopping_ = true;
    keeps_.join();
  }
  HalfOpenClients(const HalfOpenClients&) = delete;
  HalfOpenClients& operator=(const HalfOpenClients&) = delete;

 private:
  void Keep(int port, int count) {
    std::list<Socket> held;
    for (int i = 0; i < count; ++i) Open(port, i, held);
    begun_.set_value();
    for (int i = 0; !stopping_; ++i) {
      held.front().Send("a");
      const bool is_closed = held.front().ClosesWithin(1);
      held.splice(held.end(), held, held.begin());
      if (!is_closed) continue;
      held.pop_back();
      Open(port, i, held);
    }
  }
  static void Open(int port, int idx, std::list<Socket>& held) {
    if (idx % 2 == 0)
      held.emplace_back(port).Send("GET / HTTP/1.1\r\nHos");
    else
      held.emplace_back(port);
  }

  std::atomic<bool> stopping_{false};
  std::promise<void> begun_;
  std::thread keeps_;
};

// 200 wait at once; of 500 the oldest are put out.
TEST_F(HttpFixture, HalfOpenConnectionsDoNotStopIt) {
  options_.request_timeout_ms = 500;  // so that all of them leave and come back several times
  const int port = Start();
  for (const int count : {200, 500}) {
    const HalfOpenClients clients(port, count);
    for (int i = 0; i < 30; ++i) {
      SCOPED_TRACE(std::to_string(count) + " half open, request " + std::to_string(i));
      ExpectAnsweredAtOnce(port);
    }
  }
}

TEST_F(HttpFixture, RequestInPiecesIsAnswered) {
  const int port = Start();
  const Socket slow(port);
  for (const char* piece : {"GET /x HT", "TP/1.1\r\n", "Host: localhost\r", "\n\r", "\n"}) {
    slow.Send(piece);
    ExpectAnsweredAtOnce(port);
  }
  EXPECT_EQ(Parsed(slow.ReadAll()).body, "path /x query ");
}

TEST_F(HttpFixture, TricklingDoesNotPutOffTheEnd) {
  options_.request_timeout_ms = 300;
  const int port = Start();
  const Socket slow(port);
  slow.Send("GET / HTTP/1.1\r\nX: ");
  EXPECT_LT(SecondsOf([&] {
              while (!slow.ClosesWithin(10)) slow.Send("a");
            }),
            10.0);
}

TEST(Head, IsWholeAtItsEndOrWhereItIsRefused) {
  EXPECT_EQ(JudgeHead(""), Head::kPartial);
  EXPECT_EQ(JudgeHead("GET / HTTP/1.1\r\nHost: a\r\n"), Head::kPartial);
  EXPECT_EQ(JudgeHead("GET / HTTP/1.1\r\nHost: a\r\n\r\n"), Head::kWhole);
  EXPECT_EQ(JudgeHead("GET / HTTP/1.1\n\n"), Head::kWhole);
  EXPECT_EQ(JudgeHead("POST / HTTP/1.1\r\n\r\nbody"), Head::kWhole);
  EXPECT_EQ(JudgeHead("\x16\x03\x01"), Head::kWhole);  // TLS: refused at once
  EXPECT_EQ(JudgeHead(std::string(kHeadBytesMax - 1, 'a')), Head::kPartial);
  EXPECT_EQ(JudgeHead(std::string(kHeadBytesMax, 'a')), Head::kWhole);
}

TEST_F(HttpFixture, ClientsThatDoNotReadDoNotStopIt) {
  Write("reports/mapper-01/7/large.bin", std::string(30'000'000, 'x'));
  const int port = Start();
  std::list<Socket> deaf;
  for (int i = 0; i < 16; ++i)
    deaf.emplace_back(port).Send("GET /robots/mapper-01/revisions/7/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  ExpectAnsweredAtOnce(port);
}

TEST_F(HttpFixture, RequestThatNeverEndsIsDropped) {
  options_.request_timeout_ms = 200;
  const int port = Start();
  const Socket slow(port);
  slow.Send("GET / HTTP/1.1\r\nHost: a\r\nX-Slow: ");
  EXPECT_LT(SecondsOf([&] { (void)slow.ReadAll(); }), 10.0);
}

TEST_F(HttpFixture, AnnouncedBodyIsNotWaitedFor) {
  const int port = Start();
  for (const std::string headers : {"Content-Length: 1000000000000\r\n", "Transfer-Encoding: chunked\r\n"}) {
    Reply reply;
    EXPECT_LT(SecondsOf([&] { reply = Ask(port, "POST", "/", headers); }), 1.0) << headers;
    EXPECT_EQ(reply.status, 405) << headers;
    EXPECT_LT(SecondsOf([&] { reply = Get(port, "/", headers); }), 1.0) << headers;
    EXPECT_EQ(reply.status, 200) << headers;
  }
}

TEST_F(HttpFixture, GarbageIsRefusedAndTheServerLives) {
  const int port = Start();
  for (const std::string& text :
       {std::string("\x16\x03\x01\x02\x00 tls\r\n\r\n", 15), std::string("GET\r\n\r\n"),
        std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET /") + std::string(100'000, 'a') + " HTTP/1.1\r\n\r\n",
        std::string("GET * HTTP/1.1\r\n\r\n"), std::string("\r\n\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nRange: bytes=-\r\nIf-None-Match: ,,,W/\r\n\r\n")}) {
    const Socket socket(port);
    socket.Send(text);
    (void)socket.ReadAll();
  }
  EXPECT_EQ(Get(port, "/").status, 200);
}

TEST_F(HttpFixture, ManyClientsAtOnceAllGetTheirOwnAnswer) {
  const int port = Start();
  std::vector<std::future<int>> clients;
  for (int client = 0; client < 8; ++client)
    clients.push_back(std::async(std::launch::async, [port, client] {
      int wrong = 0;
      for (int i = 0; i < 50; ++i) {
        const std::string path = "/c" + std::to_string(client) + "/" + std::to_string(i);
        wrong += Get(port, path).body == "path " + path + " query " ? 0 : 1;
      }
      return wrong;
    }));
  for (auto& client : clients) EXPECT_EQ(client.get(), 0);
}

}  // namespace
}  // namespace rigcal::http
