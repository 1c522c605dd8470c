// What forms and cookies say, where a login leads, how often passwords may be tried, the page itself.
#include "server/http/logins/form.h"

#include <gmock/gmock.h>

#include "server/http/logins/known_browsers.h"
#include "server/http/logins/login_throttle.h"
#include "server/http/pages/login_page.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Form, IsDecodedAndTheFirstOfANameHolds) {
  const auto form = ReadForm("name=ada+l%2e&password=%26%3D%25&name=eve&empty=&alone");
  ASSERT_TRUE(form);
  EXPECT_EQ(FieldOf(*form, "name"), "ada l.");
  EXPECT_EQ(FieldOf(*form, "password"), "&=%");
  EXPECT_EQ(FieldOf(*form, "empty"), "");
  EXPECT_EQ(FieldOf(*form, "none"), "");
  EXPECT_FALSE(ReadForm("name=%zz"));
  EXPECT_FALSE(ReadForm("name=%4"));
}

TEST(Cookie, IsFoundByItsWholeNameAndOnce) {
  EXPECT_EQ(CookieOf("a=1; rigcal-80=x=y; b=2", "rigcal-80"), "x=y");
  EXPECT_EQ(CookieOf("arigcal-80=1", "rigcal-80"), "");
  EXPECT_EQ(CookieOf("rigcal-8=1", "rigcal-80"), "");
  EXPECT_EQ(CookieOf("rigcal-80=1; rigcal-80=2", "rigcal-80"), "");
  EXPECT_EQ(CookieOf("", "rigcal-80"), "");
}

TEST(Cookie, IsForNoScriptAndNoOtherSite) {
  EXPECT_EQ(CookieText("n", "v", true), "n=v; Path=/; HttpOnly; SameSite=Strict; Secure");
  EXPECT_EQ(CookieText("n", "", false), "n=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0");
}

TEST(Login, LeadsToThisServerOnly) {
  for (const std::string own : {"/", "/robots/a/", "/robots/a/compare?a=1&b=2", "/a%20b"}) EXPECT_EQ(OwnPath(own), own);
  for (const std::string other : {"", "//evil.example/", "https://evil.example", "/\\evil.example",
                                  "/a\r\nSet-Cookie: x=y", "/../x", "javascript:x", "/%zz"})
    EXPECT_EQ(OwnPath(other), "/") << other;
}

TEST(OwnPage, IsOfThisHostAndPort) {
  EXPECT_TRUE(IsOwnPage("http://rigs:8420", "rigs:8420", ""));
  EXPECT_TRUE(IsOwnPage("https://rigs", "rigs", "same-origin"));
  EXPECT_TRUE(IsOwnPage("", "rigs", "same-origin"));
  EXPECT_FALSE(IsOwnPage("", "rigs", ""));
  EXPECT_FALSE(IsOwnPage("", "rigs", "same-site"));
  EXPECT_FALSE(IsOwnPage("http://rigs:8421", "rigs:8420", "same-origin"));
  EXPECT_FALSE(IsOwnPage("http://evil.example", "rigs", "same-origin"));
  EXPECT_FALSE(IsOwnPage("null", "rigs", ""));
  EXPECT_FALSE(IsOwnPage("http://", "", ""));
}

class ThrottleTest : public ::testing::Test {
 protected:
  int Tries(const std::string& address, const std::string& name, int count, int at_s) {
    int passed = 0;
    for (int i = 0; i < count; ++i)
      passed += throttle_.Try(address, name, LoginThrottle::Time(std::chrono::seconds(at_s))) ? 1 : 0;
    return passed;
  }
  LoginThrottle throttle_;
};

TEST_F(ThrottleTest, AnAddressTriesFiveAndThenOneEveryTwelveSeconds) {
  EXPECT_EQ(Tries("10.0.0.1", "ada", 100, 0), 5);
  EXPECT_EQ(Tries("10.0.0.1", "eve", 100, 0), 0);
  EXPECT_EQ(Tries("10.0.0.2", "bob", 100, 0), 5);
  EXPECT_EQ(Tries("10.0.0.1", "eve", 100, 13), 1);
  EXPECT_EQ(Tries("10.0.0.1", "eve", 100, 10'000), 5);
}

TEST_F(ThrottleTest, ANameIsTriedTwentyTimesFromAllTogether) {
  int passed = 0;
  for (int i = 0; i < 50; ++i) passed += Tries("10.0.1." + std::to_string(i), "ada", 1, 0);
  EXPECT_EQ(passed, 20);
  EXPECT_EQ(Tries("10.0.2.1", "eve", 1, 0), 1);
  EXPECT_EQ(Tries("10.0.2.2", "ada", 9, 10), 3);
}

TEST_F(ThrottleTest, WhoIsRightIsHeldUpAfterTwentyLoginsAtOnce) {
  int right = 0;
  for (; right < 100 && Tries("10.0.0.1", "ada", 1, 0) == 1; ++right) throttle_.WasRight("10.0.0.1");
  EXPECT_EQ(right, 20);
  EXPECT_EQ(Tries("10.0.0.1", "bob", 9, 0), 5) << "others of the same address are not";
  EXPECT_EQ(Tries("10.0.0.2", "ada", 9, 30), 5);
}

TEST_F(ThrottleTest, WhatIsNotLookedAtCostsNothing) {
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(Tries("10.0.0.1", "ada", 1, 0), 1);
    throttle_.GiveBack("10.0.0.1", "ada");
  }
}

TEST(KnownBrowsers, AreThoseOfOneNameAndOneServer) {
  const KnownBrowsers known, other;
  const std::string mark = known.MarkFor("ada");
  EXPECT_EQ(mark.size(), 64u);
  EXPECT_NE(mark, known.MarkFor("ada"));
  EXPECT_TRUE(known.Has(mark, "ada"));
  EXPECT_FALSE(known.Has(mark, "bob"));
  EXPECT_FALSE(other.Has(mark, "ada"));
  for (const std::string& odd : {std::string(), mark.substr(0, 63), mark + "0", std::string(64, '0')})
    EXPECT_FALSE(known.Has(odd, "ada")) << odd;
}

TEST_F(ThrottleTest, TheLogIsToldOnceAMinute) {
  const auto told = [this](const std::string& address, int at_s) {
    return throttle_.CountToTell(address, LoginThrottle::Time(std::chrono::seconds(at_s)));
  };
  EXPECT_EQ(told("10.0.0.1", 0), 1);
  for (int at_s = 1; at_s < 60; ++at_s) EXPECT_EQ(told("10.0.0.1", at_s), 0);
  EXPECT_EQ(told("10.0.0.2", 30), 1);
  EXPECT_EQ(told("10.0.0.1", 60), 60);
  EXPECT_EQ(told("10.0.0.1", 61), 0);
}

TEST_F(ThrottleTest, NetworksOfIpv6CountAsOneAndNothingPilesUp) {
  int passed = 0;
  for (int i = 0; i < 50; ++i) passed += Tries("2001:db8::" + std::to_string(i), "n" + std::to_string(i), 1, 0);
  EXPECT_EQ(passed, 5);
  EXPECT_EQ(Tries("fe80::1%eth0", "eve", 9, 0) + Tries("fe80::2%eth1", "bob", 9, 0), 5)
      << "nor does a zone make another of it";
  for (int i = 0; i < 20'000; ++i)
    Tries("10." + std::to_string(i / 250) + ".0." + std::to_string(i % 250), "m" + std::to_string(i), 1, 0);
  EXPECT_EQ(Tries("10.200.0.1", "new", 5, 0), 5);
}

TEST(LoginPage, EscapesWhatWasTypedAndNeedsNoScript) {
  const std::string page = WriteLoginPage({"token", "/a?b=\"<", "\"><script>x</script>", "No <b>."});
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, HasSubstr("No &lt;b&gt;."));
  EXPECT_THAT(page, HasSubstr("value=\"/a?b=&quot;&lt;\""));
  EXPECT_THAT(page, HasSubstr("name=\"form\" value=\"token\""));
  EXPECT_THAT(page, HasSubstr("method=\"post\""));
}

}  // namespace
}  // namespace rigcal::http
