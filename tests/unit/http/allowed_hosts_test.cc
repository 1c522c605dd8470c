#include "server/http/allowed_hosts.h"

#include <gmock/gmock.h>

#include "tests/unit/http/client.h"

namespace rigcal::http {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(AllowedHosts, HasItsNamesAndAddressesInDigits) {
  const AllowedHosts allowed({"Mars", "https://rigs.example.org/rigcal", "rig.local."});
  for (const char* host : {"localhost", "LOCALHOST:8420", "localhost.", "127.0.0.1", "127.0.0.1:8420", "192.168.1.5:1",
                           "[::1]", "[2001:db8::7]:8420", "mars", "MARS:80", "rigs.example.org", "rig.local", "mars:"})
    EXPECT_TRUE(allowed.Has(host)) << host;
}

TEST(AllowedHosts, HasNothingElse) {
  const AllowedHosts allowed({"mars", ""});
  for (const char* host : {"",
                           "evil.example",
                           "mars.evil.example",
                           "localhost.evil.example",
                           "127.0.0.1.evil.example",
                           "xmars",
                           "mars x",
                           "me@mars",
                           "mars:80:80",
                           "mars:x",
                           "[::1",
                           "[::1]x",
                           "[mars]",
                           "127.1",
                           "0x7f.0.0.1",
                           "2130706433",
                           "mars/",
                           "127.0.0.1, evil.example",
                           ".",
                           "localhost.."})
    EXPECT_FALSE(allowed.Has(host)) << host;
}

TEST(AllowedHosts, OfNamesThatNobodyCanAskByNoneIsGiven) {
  for (const char* name : {"Mars", "rigs.example.org.", "https://rigs.example.org/rigcal", "192.168.1.5", "[::1]:8420"})
    EXPECT_TRUE(CheckHostName(name)) << name;
  for (const char* name : {"", "*", "*.example.org", "ev il", "mars/", "mars:x", "[mars]", "https://"}) {
    const Status checked = CheckHostName(name);
    ASSERT_FALSE(checked) << name;
    EXPECT_EQ(checked.error().code, ErrorCode::kInvalidInput);
    EXPECT_THAT(checked.error().what, HasSubstr("--http-name \"" + std::string(name) + "\""));
  }
}

TEST(AllowedHosts, OfAMachine) {
  EXPECT_THAT(NamesOfMachine("Mars"), ElementsAre("mars", "mars", "mars.local"));
  EXPECT_THAT(NamesOfMachine("mars.lab.example"), ElementsAre("mars.lab.example", "mars", "mars.local"));
  EXPECT_THAT(NamesOfMachine("(none)"), IsEmpty());
  EXPECT_THAT(NamesOfMachine(""), IsEmpty());
}

TEST(AllowedHosts, LoopbackIsThisMachineAlone) {
  for (const char* host : {"127.0.0.1", "127.9.9.9", "localhost", "[::1]"}) EXPECT_TRUE(IsLoopback(host)) << host;
  for (const char* host : {"0.0.0.0", "[::]", "192.168.1.5", "mars", "127.evil.example", "", "127.0.0.1.example"})
    EXPECT_FALSE(IsLoopback(host)) << host;
}

int StatusFor(const Caller& caller) {
  const auto refusal = RefusalOf(AllowedHosts({"mars"}), caller);
  return refusal ? refusal->status : 0;
}

TEST(Caller, IsToldWhyInOneSentence) {
  EXPECT_EQ(StatusFor({{"mars:8420"}, {}, "/", "1.1"}), 0);
  EXPECT_EQ(StatusFor({{"mars"}, {"http://mars:8420"}, "/", "1.1"}), 0);
  EXPECT_EQ(StatusFor({{}, {}, "/", "1.0"}), 0);
  EXPECT_EQ(StatusFor({{}, {}, "/", "1.1"}), 400);
  EXPECT_EQ(StatusFor({{"mars", "mars"}, {}, "/", "1.1"}), 400);
  EXPECT_EQ(StatusFor({{"evil.example"}, {}, "/", "1.1"}), 421);
  EXPECT_EQ(StatusFor({{"mars"}, {}, "http://evil.example/", "1.1"}), 421);
  EXPECT_EQ(StatusFor({{"mars"}, {}, "http://mars/", "1.1"}), 0);
  for (const char* origin : {"http://evil.example", "null", "", "file://", "http://", "https://mars.evil.example"})
    EXPECT_EQ(StatusFor({{"mars"}, {origin}, "/", "1.1"}), 403) << origin;
  const auto refusal = RefusalOf(AllowedHosts({}), {{"rigs.example.org:80"}, {}, "/", "1.1"});
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->error.what, HasSubstr("\"rigs.example.org:80\""));
  EXPECT_THAT(refusal->error.cure, HasSubstr("`--http-name rigs.example.org`"));
}

Reply AskRaw(int port, const std::string& request) {
  const Socket socket(port);
  socket.Send(request);
  return Parsed(socket.ReadAll());
}

TEST_F(HttpFixture, OtherHostsAreRefusedBeforeAnythingIsLookedAt) {
  options_.names = {"rigs.example.org"};
  const int port = Start();
  for (const std::string path : {"/", "/robots/mapper-01/revisions/7/", "/api/v1/x", "/healthz", "/../x"}) {
    EXPECT_EQ(AskRaw(port, "GET " + path + " HTTP/1.1\r\nHost: evil.example\r\n\r\n").status, 421) << path;
    EXPECT_NE(AskRaw(port, "GET " + path + " HTTP/1.1\r\nHost: rigs.example.org\r\n\r\n").status, 421) << path;
  }
  const Reply page = AskRaw(port, "GET / HTTP/1.1\r\nHost: a<b>.example\r\n\r\n");
  EXPECT_EQ(page.status, 421);
  EXPECT_THAT(page.body, HasSubstr("This server is not known as &quot;a&lt;b&gt;.example&quot;."));
  EXPECT_EQ(AskRaw(port, "GET / HTTP/1.1\r\n\r\n").status, 400);
}

TEST_F(HttpFixture, PagesOfOtherSitesMayNotAsk) {
  const int port = Start();
  EXPECT_EQ(Get(port, "/", "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(Get(port, "/", "Origin: null\r\n").status, 403);
  EXPECT_EQ(Get(port, "/", "Origin: http://localhost:" + std::to_string(port) + "\r\n").status, 200);
}

}  // namespace
}  // namespace rigcal::http
