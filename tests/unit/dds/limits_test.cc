// Limits that were set at start-up: they judge what enters, not what is stored.
#include <gmock/gmock.h>

#include "server/base/limits_in_force.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using testing::HasSubstr;
using wire::Receipt;
using wire::ReceiptState;

class LimitsTest : public ServiceTest {
 protected:
  ~LimitsTest() override { limits::Enforce({}); }
  void Restart(const limits::Limits& limits) {
    StopServer();
    limits::Enforce(limits);
    StartServer();
  }
  // The server's last word on a session of two files.
  Receipt Offer(const Session& session) {
    Client client = MakeClient(session.robot.str());
    client.SendManifest(session);
    return client.Await(session.id.str(), [](const Receipt& one) {
      return one.state == ReceiptState::kRefused || one.state == ReceiptState::kClosed ||
             one.state == ReceiptState::kReceiving;
    });
  }
};

TEST_F(LimitsTest, AStricterLimitRefusesANewSessionAndKeepsTheStoredOne) {
  const Session stored = MakeSession("mapper-01", {5'000, 6'000}, 1);
  {
    Client client = MakeClient("mapper-01");
    client.SendManifest(stored);
    client.AwaitState(stored.id.str(), ReceiptState::kReceiving);
    client.SendPayload(stored, 0);
    client.SendPayload(stored, 1);
    client.AwaitState(stored.id.str(), ReceiptState::kClosed);
  }
  limits::Limits strict;
  strict.payloads_per_session = 1;
  Restart(strict);
  EXPECT_EQ(Offer(stored).state, ReceiptState::kClosed);
  const Receipt refused = Offer(MakeSession("mapper-01", {5'000, 6'000}, 9));
  EXPECT_EQ(refused.state, ReceiptState::kRefused);
  ASSERT_TRUE(refused.error);
  EXPECT_THAT(refused.error->what, HasSubstr("too many files, 2"));
  EXPECT_THAT(refused.error->cure, HasSubstr("payloads_per_session"));
}

TEST_F(LimitsTest, TheWindowIsTheOneThatWasSet) {
  limits::Limits narrow;
  narrow.window_bytes = 3 << 20;
  Restart(narrow);
  EXPECT_EQ(Offer(MakeSession("mapper-01", {5'000, 6'000}, 2)).window_bytes, 3u << 20);
}

}  // namespace
}  // namespace rigcal::dds
