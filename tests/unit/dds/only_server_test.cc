#include "server/dds/only_server.h"

#include <gmock/gmock.h>

#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using wire::ServerName;
using wire::ServerState;

ServerName Named(const std::string& id, ServerState state, std::int64_t since_ns) {
  return {id, state, {since_ns}, "host", 1, "/data"};
}

TEST(GoesBefore, OfAnyTwoThatWantThePlaceExactlyOne) {
  std::vector<ServerName> names;
  for (const ServerState state : {ServerState::kClaims, ServerState::kServes})
    for (const std::int64_t since_ns : {5, 6})
      for (const char* id : {"a", "b"}) names.push_back(Named(id + std::to_string(names.size()), state, since_ns));
  for (const ServerName& x : names)
    for (const ServerName& y : names)
      if (x.id != y.id) {
        EXPECT_NE(GoesBefore(x, {y}).has_value(), GoesBefore(y, {x}).has_value()) << x.id << y.id;
      }
}

TEST(GoesBefore, WhoServesThenTheEarlierThenTheSmallerId) {
  const ServerName self = Named("m", ServerState::kClaims, 10);
  EXPECT_FALSE(GoesBefore(self, {}));
  EXPECT_FALSE(GoesBefore(self, {self}));  // its own
  EXPECT_TRUE(GoesBefore(self, {Named("z", ServerState::kServes, 99)}));
  EXPECT_TRUE(GoesBefore(self, {Named("z", ServerState::kClaims, 9)}));
  EXPECT_FALSE(GoesBefore(self, {Named("a", ServerState::kClaims, 11)}));
  EXPECT_TRUE(GoesBefore(self, {Named("a", ServerState::kClaims, 10)}));
  EXPECT_FALSE(GoesBefore(self, {Named("z", ServerState::kClaims, 10)}));
  EXPECT_FALSE(GoesBefore(self, {Named("a", ServerState::kWaits, 1)}));
  EXPECT_EQ(GoesBefore(self, {Named("y", ServerState::kClaims, 9), Named("z", ServerState::kServes, 99)})->id, "z");
  const ServerName waits = Named("m", ServerState::kWaits, 1);
  EXPECT_TRUE(GoesBefore(waits, {Named("z", ServerState::kClaims, 99)}));
  EXPECT_FALSE(GoesBefore(waits, {Named("a", ServerState::kWaits, 0)}));
}

TEST(GoesBefore, AnOlderServerWasThereBefore) {
  ServerName older;
  older.id = "zz";
  EXPECT_TRUE(GoesBefore(Named("a", ServerState::kServes, 1), {older}));
}

class OnlyServerTest : public testing::Test {
 protected:
  OnlyServer Open(const std::string& folder, bool waits = false, const std::string& store = {}) {
    return Must(OnlyServer::Open(options_, folder, waits, store));
  }
  wire::ParticipantOptions options_ = [] {
    wire::ParticipantOptions options;
    options.tag = RandomTag();
    return options;
  }();
};

TEST_F(OnlyServerTest, ASecondOneIsToldWhoAndWhere) {
  OnlyServer first = Open("/srv/one");
  ASSERT_TRUE(first.Settle());
  OnlyServer second = Open("/srv/two");
  const Status settled = second.Settle();
  ASSERT_FALSE(settled);
  EXPECT_EQ(settled.error().code, ErrorCode::kConflict);
  EXPECT_THAT(settled.error().what, testing::HasSubstr("(process " + std::to_string(getpid()) + ", data in /srv/one)"));
  EXPECT_THAT(settled.error().cure, testing::HasSubstr("--standby"));
  EXPECT_FALSE(Must(first.Before()));
}

TEST_F(OnlyServerTest, ASecondOneKnowsWhetherTheFirstIsOfItsStore) {
  OnlyServer first = Open("/srv/one", false, "5");
  ASSERT_FALSE(Must(first.TryToSettle()));
  for (const char* store : {"5", "6", ""}) {
    OnlyServer second = Open("/srv/one", false, store);
    const auto serves = Must(second.TryToSettle());
    ASSERT_TRUE(serves);
    EXPECT_EQ(second.SharesStoreWith(*serves), serves->store == store);
    EXPECT_EQ(serves->store, "5");
  }
  EXPECT_FALSE(Open("/srv/two").SharesStoreWith({})) << "each has its own";
}

TEST_F(OnlyServerTest, OneThatGaveWayLeavesThePlaceToTheNext) {
  OnlyServer first = Open("/srv/one", false, "5"), second = Open("/srv/one", true, "5");
  ASSERT_TRUE(first.Settle());
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!Must(second.Before()) && std::chrono::steady_clock::now() < deadline) {
  }
  ASSERT_TRUE(first.GiveWay());
  while (Must(second.Before()) && std::chrono::steady_clock::now() < deadline) {
  }
  ASSERT_TRUE(second.Claim());
  EXPECT_TRUE(second.Settle());
  EXPECT_TRUE(Must(first.Before()));
}

TEST_F(OnlyServerTest, OfTwoAtOnceExactlyOneServes) {
  for (int round = 0; round < 5; ++round) {
    OnlyServer x = Open("/srv/x"), y = Open("/srv/y");
    const bool x_serves = x.Settle().has_value(), y_serves = y.Settle().has_value();
    EXPECT_NE(x_serves, y_serves);
  }
}

TEST_F(OnlyServerTest, OneThatWaitsTakesThePlaceWhenItIsFree) {
  auto first = std::make_unique<OnlyServer>(Open("/srv/one"));
  ASSERT_TRUE(first->Settle());
  OnlyServer second = Open("/srv/two", true);
  ASSERT_TRUE(second.Claim());
  ASSERT_FALSE(second.Settle());
  EXPECT_TRUE(Must(second.Before()));
  EXPECT_FALSE(Must(first->Before()));
  first.reset();
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (Must(second.Before()) && std::chrono::steady_clock::now() < deadline) {
  }
  ASSERT_TRUE(second.Claim());
  EXPECT_TRUE(second.Settle());
}

}  // namespace
}  // namespace rigcal::dds
