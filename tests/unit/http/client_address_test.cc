#include "server/http/connections/client_address.h"

#include <civetweb.h>
#include <gtest/gtest.h>

#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

TEST(ClientAddress, IsThatOfTheConnectionWithoutAProxy) {
  EXPECT_EQ(ClientAddress("10.0.0.7", "", {"1.2.3.4"}), "10.0.0.7");
  EXPECT_EQ(ClientAddress("10.0.0.7", "10.0.0.8", {"1.2.3.4"}), "10.0.0.7");
  EXPECT_EQ(ClientAddress("10.0.0.7", "10.0.0.7", {}), "10.0.0.7");
}

TEST(ClientAddress, IsWhatTheProxyAddedItself) {
  const auto told = [](const std::vector<std::string_view>& headers) {
    return ClientAddress("127.0.0.1", "127.0.0.1", headers);
  };
  EXPECT_EQ(told({"1.2.3.4"}), "1.2.3.4");
  EXPECT_EQ(told({"9.9.9.9, 1.2.3.4 "}), "1.2.3.4");
  EXPECT_EQ(told({"9.9.9.9", "1.2.3.4"}), "1.2.3.4");
  EXPECT_EQ(told({"2001:DB8::0:1"}), "2001:db8::1");
  EXPECT_EQ(told({"[2001:db8::1]"}), "2001:db8::1");
  for (const char* odd : {"", ",", "1.2.3.4,", "1.2.3.4, unknown", "1.2.3.4:80", "01.2.3.4x"})
    EXPECT_EQ(told({odd}), "127.0.0.1") << odd;
}

TEST(ClientAddress, OneAddressHasOneText) {
  EXPECT_EQ(PlainAddress("::ffff:10.0.0.1"), "10.0.0.1");
  EXPECT_EQ(PlainAddress("0:0:0:0:0:0:0:1"), "::1");
  EXPECT_FALSE(PlainAddress("localhost"));
  EXPECT_FALSE(PlainAddress(""));
  EXPECT_EQ(ClientAddress("::ffff:10.0.0.1", "10.0.0.1", {"1.2.3.4"}), "1.2.3.4");
}

TEST_F(HttpFixture, WithoutIpv6ItSaysSo) {
  if (mg_check_feature(MG_FEATURES_IPV6) != 0) GTEST_SKIP() << "this civetweb has it";
  options_.host = "[::1]";
  const auto server =
      Server::Start(options_, [](const std::string&, const std::string&) -> Result<Page> { return Page{}; });
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().what, "the HTTP address [::1] is of IPv6, which this system's civetweb has not");
}

TEST_F(HttpFixture, ProxyIsAnAddressInDigits) {
  options_.proxy = "proxy.example";
  const auto server =
      Server::Start(options_, [](const std::string&, const std::string&) -> Result<Page> { return Page{}; });
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().what, "the proxy \"proxy.example\" is not an address");
}

}  // namespace
}  // namespace rigcal::http
