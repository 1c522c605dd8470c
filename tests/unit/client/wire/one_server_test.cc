#include "client/wire/one_server.h"

#include <gmock/gmock.h>

#include "client/exit_code.h"
#include "client/wire/connection.h"
#include "tests/unit/client/fake_server.h"

namespace rigcal::client {
namespace {

using std::chrono::seconds;
using wire::ServerName;
using wire::ServerState;

const ServersSeen::Time kStart{seconds(1000)};

ServerName At(const std::string& host, const std::string& folder, ServerState state = ServerState::kServes) {
  return {host + folder, state, {1}, host, 7, folder};
}

TEST(OneServer, TwoThatANewcomerMeetsAreToldAtOnce) {
  ServersSeen seen("DDS domain 0", kStart);
  EXPECT_TRUE(seen.Judge({}, kStart));
  EXPECT_TRUE(seen.Judge({At("pc-1", "/a")}, kStart + milliseconds(10)));
  const Status judged = seen.Judge({At("pc-1", "/a"), At("pc-2", "/b")}, kStart + milliseconds(20));
  ASSERT_FALSE(judged);
  EXPECT_EQ(static_cast<int>(ExitCodeOf(judged.error())), 3);
  EXPECT_EQ(judged.error().what,
            "two servers are on DDS domain 0: rigcald on pc-1 (process 7, data in /a), and rigcald on pc-2 (process 7, "
            "data in /b)");
}

TEST(OneServer, WhoDoesNotServeIsNoSecondOne) {
  ServersSeen seen("DDS domain 0", kStart);
  EXPECT_TRUE(seen.Judge(
      {At("pc-1", "/a"), At("pc-2", "/b", ServerState::kWaits), At("pc-3", "/c", ServerState::kClaims)}, kStart));
}

TEST(OneServer, ARestartOnTheSameDataIsTheSameServer) {
  ServersSeen seen("DDS domain 0", kStart);
  ServerName again = At("pc-1", "/a");
  again.id = "another";
  EXPECT_TRUE(seen.Judge({At("pc-1", "/a"), again}, kStart));
}

// The lease of the one that was killed is not over when the other takes its place.
TEST(OneServer, ATakeoverIsNotTwoServersButTwoThatStayAre) {
  ServersSeen seen("DDS domain 0", kStart);
  const std::vector<ServerName> both = {At("pc-1", "/a"), At("pc-2", "/b")};
  EXPECT_TRUE(seen.Judge({both[0]}, kStart));
  EXPECT_TRUE(seen.Judge(both, kStart + seconds(60)));
  EXPECT_TRUE(seen.Judge(both, kStart + seconds(63)));
  EXPECT_TRUE(seen.Judge({both[1]}, kStart + seconds(64)));
  EXPECT_TRUE(seen.Judge({both[1]}, kStart + seconds(600)));
  EXPECT_TRUE(seen.Judge(both, kStart + seconds(601)));
  EXPECT_FALSE(seen.Judge(both, kStart + seconds(606)));
}

TEST(OneServer, AQuestionToTwoServersIsNotAnswered) {
  FakeServer first("r"), second("r");
  const auto participant = wire::Participant::Open(TestPlace()).value();
  auto connection = Connection::Open(participant, TestPlace()).value();
  OneServer one_server = OneServer::Open(participant, "here").value();
  const auto deadline = std::chrono::steady_clock::now() + seconds(30);
  while (one_server.Check() && std::chrono::steady_clock::now() < deadline) {
  }
  const auto answer = connection.Ask("status", "{}", milliseconds(10'000));
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kUnreachable);
  EXPECT_THAT(answer.error().what, testing::HasSubstr("an older rigcald"));
}

}  // namespace
}  // namespace rigcal::client
