// A closed session of which the server's disk has lost a file: pushed again, that file alone travels.
#include <gmock/gmock.h>

#include "storage/files/blobs.h"
#include "storage/files/lost_blobs.h"
#include "storage/sessions/sessions.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using testing::ElementsAre;
using wire::Receipt;
using wire::ReceiptState;

using LostFileTest = ServiceTest;

// The bits come in whole bytes.
std::vector<bool> FirstThree(const Receipt& receipt) { return {receipt.held.begin(), receipt.held.begin() + 3}; }

TEST_F(LostFileTest, APushOfAClosedSessionIsAskedForWhatWasLost) {
  const Session session = MakeSession("mapper-01", {1'000, 250'000, 3'000}, 1);
  Client client = MakeClient("mapper-01");
  client.Push(session);
  storage::Store store = Must(storage::Store::Open(folder_.path()));
  const Digest lost = Sha256Of(std::string_view(session.payloads[1]));
  std::filesystem::resize_file(storage::BlobPath(store.BlobFolder(), lost), 100);
  EXPECT_EQ(Must(storage::SetDamagedAside(store.BlobFolder(), lost)), storage::BlobState::kDamaged);
  Must(storage::AppendLost(store, lost, storage::BlobState::kDamaged, std::nullopt, Stamp{1}));

  client.SendHeader(session);
  const Receipt receiving = client.AwaitState(session.id.str(), ReceiptState::kReceiving);
  EXPECT_THAT(FirstThree(receiving), ElementsAre(true, false, true));
  client.SendPayload(session, 1);
  const Receipt closed =
      client.Await(session.id.str(), [](const Receipt& one) { return one.state == ReceiptState::kClosed; });
  EXPECT_THAT(FirstThree(closed), ElementsAre(true, true, true));
  EXPECT_EQ(Must(storage::LoadBlob(store.BlobFolder(), lost, 1 << 20)), session.payloads[1]);
  EXPECT_EQ(Must(storage::LoadLost(store, 1)).count, 0);
  EXPECT_EQ(Work().size(), 2u);  // told again that there may be work
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kClosed);
}

// As after a crash between the two: the file is there again, the row is not.
TEST_F(LostFileTest, BytesThatCameTwiceAreAsGoodAsOnce) {
  const Session session = MakeSession("mapper-01", {1'000, 2'000}, 7);
  Client client = MakeClient("mapper-01");
  client.Push(session);
  storage::Store store = Must(storage::Store::Open(folder_.path()));
  const Digest lost = Sha256Of(std::string_view(session.payloads[0]));
  Must(storage::AppendLost(store, lost, storage::BlobState::kMissing, std::nullopt, Stamp{1}));
  StopServer();
  StartServer();
  Client again = MakeClient("mapper-01");
  again.SendHeader(session);
  again.AwaitState(session.id.str(), ReceiptState::kReceiving);
  again.SendPayload(session, 0);
  again.AwaitState(session.id.str(), ReceiptState::kClosed);
  EXPECT_EQ(Must(storage::LoadLost(store, 1)).count, 0);
}

// Nobody has told that it is lost: the push finds it.
class UnseenLossTest : public LostFileTest {
 protected:
  [[nodiscard]] std::filesystem::path FileOf(const std::string& content) const {
    return storage::BlobPath(folder_.path() / "blobs", Sha256Of(std::string_view(content)));
  }
  std::int64_t CountLost() {
    storage::Store store = Must(storage::Store::Open(folder_.path()));
    return Must(storage::LoadLost(store, 1)).count;
  }
  // The server asks for payload 1, and has all when it came.
  void ExpectAskedForTheSecond(Client& client, const Session& session) {
    const Receipt receiving = client.AwaitState(session.id.str(), ReceiptState::kReceiving);
    EXPECT_THAT(FirstThree(receiving), ElementsAre(true, false, true));
    client.SendPayload(session, 1);
    const Receipt closed =
        client.Await(session.id.str(), [](const Receipt& one) { return one.state == ReceiptState::kClosed; });
    EXPECT_THAT(FirstThree(closed), ElementsAre(true, true, true));
    EXPECT_EQ(std::filesystem::file_size(FileOf(session.payloads[1])), session.payloads[1].size());
    EXPECT_EQ(CountLost(), 0);
  }
  const Session session_ = MakeSession("mapper-01", {1'000, 250'000, 3'000}, 11);
};

TEST_F(UnseenLossTest, APushOfAClosedSessionIsAskedForAFileThatIsGone) {
  Client client = MakeClient("mapper-01");
  client.Push(session_);
  std::filesystem::remove(FileOf(session_.payloads[1]));
  client.SendHeader(session_);
  ExpectAskedForTheSecond(client, session_);
}

TEST_F(UnseenLossTest, APushOfAClosedSessionIsAskedForAFileThatIsEmpty) {
  Client client = MakeClient("mapper-01");
  client.Push(session_);
  std::filesystem::resize_file(FileOf(session_.payloads[1]), 0);
  client.SendManifest(session_);
  ExpectAskedForTheSecond(client, session_);
  EXPECT_TRUE(std::filesystem::exists(FileOf(session_.payloads[1]).string() + ".damaged"));
}

TEST_F(UnseenLossTest, AnotherSessionWithThatFileIsAskedForIt) {
  Client client = MakeClient("mapper-01");
  client.Push(session_);
  std::filesystem::resize_file(FileOf(session_.payloads[1]), 249'999);
  const Session other = OfRobot(session_, "mapper-01", "the same once more");
  client.SendHeader(other);
  client.AwaitState(other.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(other);
  ExpectAskedForTheSecond(client, other);
  client.SendHeader(session_);
  client.AwaitState(session_.id.str(), ReceiptState::kClosed);
}

TEST_F(UnseenLossTest, ASessionThatIsReceivedIsAskedForWhatItHeld) {
  Client client = MakeClient("mapper-01");
  client.SendHeader(session_);
  client.AwaitState(session_.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session_);
  client.SendPayload(session_, 0);
  client.SendPayload(session_, 1);
  const Receipt before = client.Await(
      session_.id.str(), [](const Receipt& one) { return one.held.size() >= 3 && one.held[0] && one.held[1]; });
  std::filesystem::remove(FileOf(session_.payloads[1]));
  client.SendHeader(session_);
  client.Await(session_.id.str(), [&](const Receipt& one) {
    return one.incarnation != before.incarnation && one.held[0] && !one.held[1];
  });
  client.SendPayload(session_, 2);
  client.Await(session_.id.str(), [](const Receipt& one) { return !one.held[1] && one.held[2]; });
  client.SendPayload(session_, 1);
  client.AwaitState(session_.id.str(), ReceiptState::kClosed);
  EXPECT_EQ(CountLost(), 0);
}

}  // namespace
}  // namespace rigcal::dds
