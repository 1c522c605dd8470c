#include "server/http/served.h"

#include <gtest/gtest.h>

#include <future>
#include <list>

#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

const Served::Time kBegin{};

TEST(Served, OneAddressGetsThreeQuarters) {
  Served served(8);
  for (int port = 1; port <= 6; ++port) {
    EXPECT_TRUE(served.HasRoomFor("10.0.0.1")) << port;
    served.Began({"10.0.0.1", port}, -1, kBegin);
  }
  EXPECT_FALSE(served.HasRoomFor("10.0.0.1"));
  EXPECT_TRUE(served.HasRoomFor("10.0.0.2"));
  served.Began({"10.0.0.2", 1}, -1, kBegin);
  served.Began({"10.0.0.3", 1}, -1, kBegin);
  EXPECT_FALSE(served.HasRoomFor("10.0.0.4"));
  served.Ended({"10.0.0.1", 3});
  served.Ended({"10.0.0.1", 3});  // told twice
  EXPECT_TRUE(served.HasRoomFor("10.0.0.1"));
  served.Began({"10.0.0.4", 1}, -1, kBegin);
  EXPECT_FALSE(served.HasRoomFor("10.0.0.1"));
}

TEST(Served, AddressesOfOneNetworkAreOne) {
  Served served(8);
  for (int port = 1; port <= 6; ++port) served.Began({"2001:db8::" + std::to_string(port), port}, -1, kBegin);
  EXPECT_FALSE(served.HasRoomFor("2001:db8::ffff"));
  EXPECT_TRUE(served.HasRoomFor("2001:db8:0:1::1"));
}

TEST(Networks, AreHalfOfAnAddress) {
  EXPECT_EQ(NetworkOf("10.0.0.1"), "10.0.0.1");
  EXPECT_EQ(NetworkOf("::ffff:10.0.0.1"), "::ffff:10.0.0.1");
  EXPECT_EQ(NetworkOf("2001:db8::1"), NetworkOf("2001:0db8:0:0:ffff::2"));
  EXPECT_NE(NetworkOf("2001:db8::1"), NetworkOf("2001:db8:0:1::1"));
  EXPECT_EQ(NetworkOf("fe80::1%eth0"), NetworkOf("fe80::2%eth1"));
}

TEST(Networks, AreCounted) {
  NetworkCounts counts;
  EXPECT_EQ(counts.Largest(), "");
  for (const char* address : {"10.0.0.1", "2001:db8::1", "2001:db8::2"}) counts.Add(address);
  EXPECT_EQ(counts.Of("2001:db8::3"), 2u);
  EXPECT_EQ(counts.Largest(), NetworkOf("2001:db8::1"));
  counts.Remove("2001:db8::1");
  EXPECT_EQ(counts.Largest(), std::min(NetworkOf("2001:db8::1"), std::string("10.0.0.1")));
  counts.Remove("2001:db8::2"), counts.Remove("2001:db8::2");
  EXPECT_EQ(counts.Largest(), "10.0.0.1");
}

TEST(Served, SmallestServerServesEverybody) {
  Served served(1);
  EXPECT_TRUE(served.HasRoomFor("10.0.0.1"));
}

TEST(Served, ClosedOnesAreForgotten) {
  Served served(1);
  served.Began({"10.0.0.1", 1}, -1, kBegin);
  EXPECT_FALSE(served.HasRoomFor("10.0.0.2"));
  served.ForgetClosed();
  EXPECT_TRUE(served.HasRoomFor("10.0.0.2"));
}

// More than there are threads, all of one address, as behind a proxy.
TEST_F(HttpFixture, HundredClientsThatDoNotReadDoNotStopIt) {
  Write("reports/mapper-01/7/large.bin", std::string(30'000'000, 'x'));
  const int port = Start();
  std::list<Socket> deaf;
  for (int i = 0; i < 100; ++i)
    deaf.emplace_back(port).Send("GET /robots/mapper-01/revisions/7/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(Get(port, "/").status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(6));
}

// Whole requests, more than may wait for a thread, while the answers take their time.
TEST_F(HttpFixture, WhoWaitsForAThreadIsNotPutOutByOneAddress) {
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  const int port = Start([released](const std::string& path, const std::string&) -> Result<Page> {
    if (path == "/slow") released.wait();
    return Page{"of " + path, "text/plain"};
  });
  std::list<Socket> crowd;
  for (int i = 0; i < 600; ++i) crowd.emplace_back(port).Send("GET /slow HTTP/1.1\r\nHost: localhost\r\n\r\n");
  std::list<Socket> others;
  for (int i = 0; i < 20; ++i) others.emplace_back(port, "127.0.0.2").Send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  for (const Socket& other : others) EXPECT_EQ(Parsed(other.ReadAll()).body, "of /");
  release.set_value();
}

// A phone at the end of a long hall, while a hundred others wait for those that do not read.
TEST_F(HttpFixture, WhoReadsSlowlyGetsItsWholeAnswer) {
  constexpr std::size_t kBytes = 30'000'000, kAtOnce = 200'000;
  Write("reports/mapper-01/7/large.bin", std::string(kBytes, 'x'));
  const int port = Start();
  const std::string request = "GET /robots/mapper-01/revisions/7/large.bin HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const Socket slow(port);
  slow.Send(request);
  std::list<Socket> deaf;
  for (int i = 0; i < 150; ++i) deaf.emplace_back(port).Send(request);
  const Socket silent(port);  // looked at between pieces: that takes its time
  std::size_t all = 0;
  for (std::size_t got = 0; (got = slow.CountPiece(kAtOnce)) > 0; (void)silent.ClosesWithin(30)) all += got;
  EXPECT_GE(all, kBytes);
}

// civetweb does not say whose a malformed request was: their places are found all the same.
TEST_F(HttpFixture, MalformedRequestsTakeNoPlaceForGood) {
  const int port = Start();
  for (int i = 0; i < 200; ++i) {
    const Socket socket(port);
    socket.Send("NONSENSE\r\n\r\n");
    (void)socket.ReadAll();
  }
  EXPECT_EQ(Get(port, "/").status, 200);
}

}  // namespace
}  // namespace rigcal::http
