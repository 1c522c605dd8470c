// A session that the server of a site sends on late, and a correction of it that came first.
#include "storage/sessions/standing.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using wire::Receipt;
using wire::ReceiptState;

class SupersededThereTest : public ServiceTest {
 protected:
  // Its second file is not there yet.
  void BeginLate(Client& client) {
    client.SendHeader(late_);
    client.AwaitState(late_.id.str(), ReceiptState::kNeedManifest);
    client.SendManifest(late_);
    client.SendPayload(late_, 0);
    client.Await(late_.id.str(), [](const Receipt& one) { return !one.held.empty() && one.held[0]; });
  }
  std::map<SessionId, Superseding> Superseded() {
    storage::Store store = Must(storage::Store::Open(folder_.path()));
    return Must(storage::LoadSuperseded(store, late_.robot));
  }
  const Session late_ = MakeSession("mapper-01", {1'000, 2'000}, 5);
  const Session corrected_ = OfRobot(late_, "mapper-01", "corrected");
};

TEST_F(SupersededThereTest, ACorrectionStaysCurrentThatCameBeforeWhatWasBegun) {
  Client client = MakeClient("mapper-01");
  BeginLate(client);
  client.Push(corrected_);
  Must(server_->TakeIn(ManifestText{late_.robot, late_.id, late_.manifest, {corrected_.id}}));
  client.SendPayload(late_, 1);
  client.AwaitState(late_.id.str(), ReceiptState::kClosed);
  const auto superseded = Superseded();
  ASSERT_TRUE(superseded.contains(late_.id));
  EXPECT_EQ(superseded.at(late_.id).by, corrected_.id);
  EXPECT_EQ(superseded.size(), 1u);
}

// All of its files are there by then: it is whole with its manifest.
TEST_F(SupersededThereTest, ACorrectionStaysCurrentThatCameWhole) {
  Client client = MakeClient("mapper-01");
  client.Push(corrected_);
  Must(server_->TakeIn(ManifestText{late_.robot, late_.id, late_.manifest, {corrected_.id}}));
  client.AwaitState(late_.id.str(), ReceiptState::kClosed);
  EXPECT_TRUE(Superseded().contains(late_.id));
  EXPECT_FALSE(Superseded().contains(corrected_.id));
}

}  // namespace
}  // namespace rigcal::dds
