// Whatever the disk changed is found by name; what can be mended is.
#include <SQLiteCpp/SQLiteCpp.h>

#include "storage/files/folder_lock.h"
#include "storage/files/lost_blobs.h"
#include "storage/sessions/detections.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;
using Kind = Finding::Kind;

constexpr std::int64_t kTwoDaysNs = 2 * 86'400'000'000'000;

class FsckTest : public UpkeepTest {
 protected:
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
};

TEST_F(FsckTest, AWholeStoreHasNothingToTell) {
  Store store = Open();
  const SessionId session = Push(store, 5);
  Calibrate(store, session);
  const FsckDone done = Found();
  EXPECT_EQ(done.unmended(), 0);
  EXPECT_EQ(done.blobs, 6);
  EXPECT_GT(done.pages, 0);
  EXPECT_EQ(Only(done, Kind::kReport), "the report of revision 1 of robot mapper-01 is not there");
}

TEST_F(FsckTest, ADamagedInputIsNamedSetAsideAndTakenAgain) {
  Store store = Open();
  const SessionId session = Push(store, 5);
  FlipByte(BlobOf(ContentOf(3)), 4);
  const FsckDone seen = Found();
  EXPECT_EQ(seen.unmended(), 1);
  EXPECT_THAT(Only(seen, Kind::kInput), HasSubstr("left/100003.png of session " + session.str().substr(0, 16) +
                                                  " of robot mapper-01 is damaged"));
  EXPECT_TRUE(LoadHeld(store, session).value()[3]) << "it only looked";

  for (const bool repair : {true, false}) {
    const FsckDone lost = Found(repair);
    EXPECT_EQ(lost.unmended(), 0);
    EXPECT_EQ(lost.lost(), 1) << "until it is pushed again";
    EXPECT_FALSE(FoundOf(lost, Kind::kInput).front().is_mended);
  }
  EXPECT_TRUE(fs::exists(BlobOf(ContentOf(3)).string() + ".damaged"));
  EXPECT_FALSE(LoadHeld(store, session).value()[3]);
  ASSERT_TRUE(AppendBlob(store.BlobFolder(), ContentOf(3)));
  ASSERT_TRUE(AppendHeld(store, session, {3}, {20}));
  const FsckDone after = Found();
  EXPECT_TRUE(FoundOf(after, Kind::kInput).empty());
  EXPECT_EQ(after.lost(), 0);
  EXPECT_THAT(Only(after, Kind::kAside), HasSubstr("1 damaged files that were set aside"));
}

TEST_F(FsckTest, AMissingInputIsNamed) {
  Store store = Open();
  Push(store, 5);
  fs::remove(BlobOf(ContentOf(0)));
  EXPECT_THAT(Only(Found(), Kind::kInput), HasSubstr("left/100000.png of session "));
  EXPECT_EQ(Found().unmended(), 1);
}

TEST_F(FsckTest, WhatDerivesIsMadeAgain) {
  Store store = Open();
  const EdgeId edge = Calibrate(store, Push(store, 5));
  FlipByte(BlobOf("picture"), 0);
  EXPECT_THAT(Only(Found(), Kind::kDerived),
              HasSubstr("of edge " + edge.str().substr(0, 16) + " of robot mapper-01 is damaged"));
  EXPECT_EQ(CountJobs(store).value(), 0);
  EXPECT_EQ(Found(true).unmended(), 0);
  EXPECT_EQ(CountJobs(store).value(), 1) << "its job runs again";
  EXPECT_EQ(CountUnpublished(store, kRobot).value(), 1);
}

TEST_F(FsckTest, APictureThatNoEdgeShowsIsNoDamage) {
  Store store = Open();
  StoredView view;
  view.picture = DigestOf("of nobody's edge");
  ASSERT_TRUE(AppendView(store, DigestOf("image"), "chessboard 1", view));
  for (const bool repair : {false, true}) {
    const FsckDone done = Found(repair);
    EXPECT_THAT(Only(done, Kind::kDerived), HasSubstr("which no edge shows, is missing"));
    EXPECT_EQ(done.unmended(), 0);
  }
}

TEST_F(FsckTest, OrphansGoWhenTheyAreOld) {
  Store store = Open();
  Push(store, 2);
  ASSERT_TRUE(AppendBlob(store.BlobFolder(), "of nobody"));
  const Finding young = FoundOf(Found(), Kind::kOrphan).at(0);
  EXPECT_THAT(young.what, HasSubstr("1 files of the last day"));
  EXPECT_THAT(young.cure, HasSubstr("No server runs"));
  {
    const auto held = HoldFolder(data());
    EXPECT_THAT(FoundOf(Found(), Kind::kOrphan).at(0).cure, HasSubstr("a push may be under way"));
  }
  const ClockAt later({SystemClock().Now().ns + kTwoDaysNs});
  EXPECT_THAT(Only(*Fsck({data()}, later), Kind::kOrphan), HasSubstr("older than a day"));
  EXPECT_TRUE(fs::exists(BlobOf("of nobody")));
  ASSERT_TRUE(Fsck({data(), true}, later));
  EXPECT_FALSE(fs::exists(BlobOf("of nobody")));
  EXPECT_TRUE(fs::exists(BlobOf(ContentOf(1))));
}

TEST_F(FsckTest, AManifestThatIsNotThatOfItsSessionIsNamed) {
  Store store = Open();
  ASSERT_TRUE(AppendSession(store, SessionId(DigestOf("another").str()), "{}", MakeManifest(1), {10}));
  EXPECT_THAT(Only(Found(), Kind::kRow), HasSubstr("the manifest of session " + DigestOf("another").str()));
}

TEST_F(FsckTest, APageOfATableIsNamedAndOfAnIndexMended) {
  std::int64_t of_index = 0;
  {
    Store store = Open();
    Push(store, 300);
    of_index =
        store.database().execAndGet("SELECT max(pageno) FROM dbstat WHERE name = 'payload_of_digest'").getInt64();
  }
  const fs::path database = data() / "rigcal.db";
  const auto pages = static_cast<std::int64_t>(fs::file_size(database)) / 4096;
  int tables = 0;
  for (std::int64_t page = 2; page <= pages; page += 7) {
    FlipByte(database, page * 4096 - 1);
    const FsckDone done = Found();
    ASSERT_FALSE(FoundOf(done, Kind::kPage).empty()) << page;
    const std::string what = FoundOf(done, Kind::kPage).front().what;
    EXPECT_THAT(what, HasSubstr("page " + std::to_string(page) + " of rigcal.db"));
    tables += what.find("(table ") != std::string::npos ? 1 : 0;
    FlipByte(database, page * 4096 - 1);
  }
  EXPECT_GT(tables, 0);
  ASSERT_GT(of_index, 0);
  EXPECT_EQ(Found().unmended(), 0);
  FlipByte(database, of_index * 4096 - 1);
  EXPECT_THAT(Only(Found(), Kind::kPage), HasSubstr("(index payload_of_digest)"));
  EXPECT_EQ(Found(true).unmended(), 0);
  EXPECT_TRUE(FoundOf(Found(), Kind::kPage).empty());
}

// Of a database with free pages, closed: the page that lists the others.
std::int64_t ListOfFreePages(const fs::path& folder) {
  {
    auto store = Store::Open(folder);
    store->database().exec(
        "CREATE TABLE gone (bytes BLOB); INSERT INTO gone VALUES (zeroblob(100000)); DROP TABLE gone");
  }
  std::ifstream database(folder / "rigcal.db", std::ios::binary);
  database.seekg(32);  // in the header: the number of that page
  std::int64_t page = 0;
  for (int i = 0; i < 4; ++i) page = page << 8 | database.get();
  return page;
}

// The first page that it lists.
std::int64_t FirstListed(const fs::path& folder, std::int64_t list) {
  std::ifstream database(folder / "rigcal.db", std::ios::binary);
  database.seekg((list - 1) * 4096 + 8);
  std::int64_t page = 0;
  for (int i = 0; i < 4; ++i) page = page << 8 | database.get();
  return page;
}

TEST_F(FsckTest, APageThatHoldsNothingIsNoDamage) {
  const std::int64_t free_page = FirstListed(data(), ListOfFreePages(data()));
  FlipByte(data() / "rigcal.db", free_page * 4096 - 96);
  for (const bool repair : {false, true}) {
    const FsckDone done = Found(repair);
    EXPECT_EQ(done.unmended(), 0);
    EXPECT_THAT(Only(done, Kind::kPage),
                HasSubstr("page " + std::to_string(free_page) + " of rigcal.db (in which no row lies)"));
    EXPECT_FALSE(FoundOf(done, Kind::kPage).front().is_damage);
  }
  EXPECT_TRUE(FoundOf(Found(), Kind::kPage).empty()) << "it was noted as it is";
}

TEST_F(FsckTest, ABrokenListOfFreePagesIsNotNotedAsGood) {
  const std::int64_t list = ListOfFreePages(data());
  FlipByte(data() / "rigcal.db", (list - 1) * 4096 + 11);  // another page than the one that is free
  for (const bool repair : {false, true, false}) {
    const FsckDone done = Found(repair);
    EXPECT_GT(done.unmended(), 0);
    EXPECT_THAT(Only(done, Kind::kPage), HasSubstr("page " + std::to_string(list) + " of rigcal.db"));
  }
}

TEST_F(FsckTest, ADatabaseThatCannotBeOpenedStillTellsItsPagesAndFiles) {
  {
    Store store = Open();
    Push(store, 5);
  }
  FlipByte(data() / "rigcal.db", 3);
  FlipByte(BlobOf(ContentOf(1)), 3);
  const FsckDone done = Found();
  EXPECT_THAT(Only(done, Kind::kPage), HasSubstr("page 1 of rigcal.db"));
  EXPECT_THAT(Only(done, Kind::kInput), HasSubstr(DigestOf(ContentOf(1)).str()));
}

TEST_F(FsckTest, LooksAtNoFolderThatIsNone) {
  EXPECT_EQ(Check().error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Check(true).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(fs::exists(data()));
}

}  // namespace
}  // namespace rigcal::storage
