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

}  // namespace
}  // namespace rigcal::dds
