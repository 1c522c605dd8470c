// The same check of a store whose rows are in PostgreSQL.
#include <gmock/gmock.h>

#include "storage/files/folder_lock.h"
#include "storage/work/servers.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;
using Kind = Finding::Kind;

class FsckServerTest : public StoreTest {
 protected:
  void SetUp() override {
    if (IsOnSqlite()) GTEST_SKIP() << "runs on PostgreSQL only: tests/postgres/with_postgres";
  }
  Result<FsckDone> Check(bool repair = false) { return Fsck({place(), repair}, SystemClock()); }
  FsckDone Found(bool repair = false) {
    auto done = Check(repair);
    if (!done) throw std::runtime_error(WordsOf(done));
    return std::move(*done);
  }
  // The words of the only finding of that kind.
  static std::string Only(const FsckDone& done, Kind kind) {
    const auto found = FoundOf(done, kind);
    return found.size() == 1 ? found.front().what : std::to_string(found.size()) + " findings";
  }
  [[nodiscard]] fs::path BlobOf(const std::string& content) { return BlobPath(store_.BlobFolder(), DigestOf(content)); }
};

TEST_F(FsckServerTest, TellsWhetherPagesAreHeldToSums) {
  Calibrate(store_, Push(store_, 5));
  const FsckDone done = Found();
  EXPECT_EQ(done.unmended(), 0);
  EXPECT_EQ(done.blobs, 6);
  EXPECT_EQ(done.pages, 0);
  EXPECT_THAT(Only(done, Kind::kPage), HasSubstr("data_checksums is off"));
  EXPECT_FALSE(FoundOf(done, Kind::kPage).front().is_damage);
  EXPECT_TRUE(FoundOf(done, Kind::kRow).empty());
}

TEST_F(FsckServerTest, ADamagedInputIsTakenAgainAndWhatDerivesIsMadeAgain) {
  const SessionId session = Push(store_, 5);
  Calibrate(store_, session);
  FlipByte(BlobOf(ContentOf(3)), 4);
  FlipByte(BlobOf("picture"), 0);
  const FsckDone seen = Found();
  EXPECT_EQ(seen.unmended(), 2);
  EXPECT_THAT(Only(seen, Kind::kInput), HasSubstr("left/100003.png of session " + session.str().substr(0, 16)));
  EXPECT_TRUE(LoadHeld(store_, session).value()[3]) << "it only looked";

  const FsckDone mended = Found(true);
  EXPECT_EQ(mended.unmended(), 0);
  EXPECT_EQ(mended.lost(), 1);
  EXPECT_FALSE(LoadHeld(store_, session).value()[3]);
  EXPECT_EQ(CountJobs(store_).value(), 1) << "its job runs again";
}

TEST_F(FsckServerTest, AMissingInputAndAnotherManifestAreNamed) {
  Push(store_, 5);
  fs::remove(BlobOf(ContentOf(0)));
  ASSERT_TRUE(AppendSession(store_, SessionId(DigestOf("another").str()), "{}", MakeManifest(1), {10}));
  const FsckDone done = Found();
  EXPECT_THAT(Only(done, Kind::kInput), HasSubstr("left/100000.png of session "));
  EXPECT_THAT(Only(done, Kind::kRow), HasSubstr("the manifest of session " + DigestOf("another").str()));
}

TEST_F(FsckServerTest, ARowThatRefersToNoneIsNamed) {
  Push(store_, 5);
  TamperWith(place(), "DELETE FROM rigcal.payload WHERE idx = 2");
  EXPECT_THAT(Only(Found(), Kind::kRow), HasSubstr("a row of the table payload_held refers to one of payload"));
}

TEST_F(FsckServerTest, NobodyRepairsWhatAServerUses) {
  {
    const auto held = HoldFolder(place().folder);
    EXPECT_EQ(Check(true).error().code, ErrorCode::kConflict);
    EXPECT_TRUE(Check());
  }
  EXPECT_EQ(Fsck({StorePlace(folder_.path() / "elsewhere", place().server), true}, SystemClock()).error().code,
            ErrorCode::kNotFound);
  EXPECT_FALSE(fs::exists(folder_.path() / "elsewhere"));
}

}  // namespace
}  // namespace rigcal::storage
