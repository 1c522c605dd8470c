// Slow, rude and many clients.
#include <chrono>
#include <future>
#include <list>

#include "server/base/limits.h"
#include "tests/unit/http_client.h"

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

TEST_F(HttpFixture, ClientsThatDoNotReadDoNotStopIt) {
  Write("reports/mapper-01/7/large.bin", std::string(30'000'000, 'x'));
  const int port = Start();
  std::list<Socket> deaf;
  for (int i = 0; i < 16; ++i)
    deaf.emplace_back(port).Send("GET /robots/mapper-01/revisions/7/large.bin HTTP/1.1\r\nHost: a\r\n\r\n");
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
