// A store whose blobs are in a bucket: its folder is a copy of a part of it.
#include "storage/s3/store_bucket.h"

#include <cstring>

#include "server/base/files/durable_file.h"
#include "storage/database/query.h"
#include "storage/files/held_files.h"
#include "storage/files/lost_blobs.h"
#include "storage/sessions/sessions.h"
#include "storage/work/servers.h"
#include "tests/unit/storage/s3/fixture.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBytesMax = 1 << 20;

class StoreBucketTest : public BucketFixture {
 protected:
  [[nodiscard]] StorePlace At(const std::string& name, const std::string& bucket) const {
    StorePlace place = database_.In(folder_.path() / name);
    place.bucket = bucket;
    return place;
  }
  Result<Store> TryOpen(const std::string& name = "one") { return Store::Open(At(name, place_)); }
  Store OpenStore(const std::string& name = "one") {
    auto store = TryOpen(name);
    if (!store) throw std::runtime_error(WordsOf(store));
    return std::move(*store);
  }
  static fs::path FileOf(const Store& store, const Digest& digest) { return BlobPath(store.BlobFolder(), digest); }

  static void NoteHeld(Store& store, const Digest& digest) {
    Query(store, "INSERT INTO robot VALUES ('r', 1) ON CONFLICT DO NOTHING").Run();
    Query(store, "INSERT INTO robot_digest_held VALUES ('r', ?, 1)").Bind(digest).Run();
  }

  TempDatabase database_{folder_.path()};
};

TEST_F(StoreBucketTest, WhatTheFolderLacksIsFetched) {
  const Store store = OpenStore();
  const Digest digest = AppendBlob(store.blobs(), "picture").value();
  ASSERT_TRUE(fs::remove(FileOf(store, digest)));
  EXPECT_FALSE(fs::exists(FileOf(store, digest)));
  EXPECT_EQ(LoadBlob(store.blobs(), digest, kBytesMax).value(), "picture");
  EXPECT_TRUE(fs::exists(FileOf(store, digest)));
  EXPECT_EQ(LookAtBlob(store.blobs(), digest).value(), BlobState::kGood);
}

TEST_F(StoreBucketTest, WhatNobodyHasIsMissing) {
  const Store store = OpenStore();
  EXPECT_FALSE(FetchBlob(store.blobs(), DigestOf("a")).value());
  EXPECT_EQ(LookAtBlob(store.blobs(), DigestOf("a")).value(), BlobState::kMissing);
  EXPECT_EQ(LoadBlob(store.blobs(), DigestOf("a"), kBytesMax).error().code, ErrorCode::kNotFound);
}

TEST_F(StoreBucketTest, AdoptedFilesAreInTheBucketAll) {
  const Store store = OpenStore();
  std::vector<FinishedFile> files;
  for (int i = 0; i < 20; ++i) {
    const std::string text = "file " + std::to_string(i);
    const fs::path path = store.IntakeFolder() / std::to_string(i);
    ASSERT_TRUE(WriteDurably(path, text));
    files.push_back({path, DigestOf(text)});
  }
  const Status adopted = AdoptBlobs(store.blobs(), files);
  ASSERT_TRUE(adopted) << WordsOf(adopted);
  for (const FinishedFile& file : files) EXPECT_TRUE(store.blobs().bucket()->Has(file.digest).value());
  EXPECT_TRUE(AdoptBlobs(store.blobs(), files)) << "moved and put before";
}

TEST_F(StoreBucketTest, WhatIsKnownToBeThereIsNotPutAgain) {
  const Store store = OpenStore();
  const fs::path path = store.IntakeFolder() / "one", other = store.IntakeFolder() / "other";
  ASSERT_TRUE(WriteDurably(path, "one"));
  ASSERT_TRUE(WriteDurably(other, "other"));
  std::set<Digest> put{DigestOf("one")};
  ASSERT_TRUE(AdoptBlobs(store.blobs(), {{path, DigestOf("one")}, {other, DigestOf("other")}}, put));
  EXPECT_FALSE(store.blobs().bucket()->Has(DigestOf("one")).value());
  EXPECT_TRUE(store.blobs().bucket()->Has(DigestOf("other")).value());
  EXPECT_EQ(put.size(), 2u);
}

TEST_F(StoreBucketTest, AnEmptyContentIsFetchedToo) {
  const Store store = OpenStore();
  const Digest digest = AppendBlob(store.blobs(), "").value();
  ASSERT_TRUE(fs::remove(FileOf(store, digest)));
  EXPECT_EQ(LoadBlob(store.blobs(), digest, kBytesMax).value(), "");
  for (const auto& entry : fs::directory_iterator(FileOf(store, digest).parent_path()))
    EXPECT_EQ(entry.path(), FileOf(store, digest)) << "nothing is left beside it";
}

TEST_F(StoreBucketTest, ADamagedCopyIsSetAsideAndFetchedAnew) {
  const Store store = OpenStore();
  const Digest digest = AppendBlob(store.blobs(), "picture").value();
  fs::resize_file(FileOf(store, digest), 3);
  EXPECT_EQ(LoadBlob(store.blobs(), digest, kBytesMax).value(), "picture");
  EXPECT_EQ(fs::file_size(FileOf(store, digest).string() + ".damaged"), 3u);
}

TEST_F(StoreBucketTest, ADamagedObjectIsDamagedUntilItIsSentAgain) {
  const Store store = OpenStore();
  const Digest digest = AppendBlob(store.blobs(), "picture").value();
  ASSERT_EQ(Replace(place_, digest, "another").status, 200);
  EXPECT_EQ(LookAtBlob(store.blobs(), digest).value(), BlobState::kGood) << "this machine has it";
  ASSERT_TRUE(fs::remove(FileOf(store, digest)));
  EXPECT_EQ(LookAtBlob(store.blobs(), digest).value(), BlobState::kDamaged);
  EXPECT_EQ(SetDamagedAside(store.blobs(), digest).value(), BlobState::kDamaged);
  EXPECT_EQ(LoadBlob(store.blobs(), digest, kBytesMax).error().code, ErrorCode::kConflict);
  EXPECT_FALSE(fs::exists(FileOf(store, digest)));
  const fs::path sent = store.IntakeFolder() / "sent";
  ASSERT_TRUE(WriteDurably(sent, "picture"));
  ASSERT_TRUE(AdoptBlobs(store.blobs(), {{sent, digest}}));
  ASSERT_TRUE(fs::remove(FileOf(store, digest)));
  EXPECT_EQ(LoadBlob(store.blobs(), digest, kBytesMax).value(), "picture");
}

TEST_F(StoreBucketTest, AServiceOutOfReachIsNoLoss) {
  Store store = OpenStore();
  const Digest digest = AppendBlob(store.blobs(), "picture").value();
  ASSERT_TRUE(fs::remove(FileOf(store, digest)));
  const Variable endpoint("AWS_ENDPOINT_URL_S3", "http://127.0.0.1:1");
  const Store cut_off = OpenStore();
  EXPECT_EQ(LookAtBlob(cut_off.blobs(), digest).error().code, ErrorCode::kUnreachable);
  EXPECT_EQ(LoadBlob(cut_off.blobs(), digest, kBytesMax).error().code, ErrorCode::kUnreachable);
  EXPECT_EQ(AppendBlob(cut_off.blobs(), "new").error().code, ErrorCode::kUnreachable);
  EXPECT_EQ(LoadLost(store, 10).value().count, 0);
}

TEST_F(StoreBucketTest, WhatIsCalledHeldHasItsLengthThereOrIsLost) {
  Store store = OpenStore();
  std::vector<HeldFile> files;
  for (const char* content : {"whole", "short", "local", "damaged here"})
    files.push_back({AppendBlob(store.blobs(), content).value(), static_cast<std::int64_t>(std::strlen(content))});
  files.push_back({DigestOf("never there"), 3});
  for (const std::size_t i : {0u, 1u}) ASSERT_TRUE(fs::remove(FileOf(store, files[i].digest)));
  ASSERT_EQ(Replace(place_, files[1].digest, "sho").status, 200);
  fs::resize_file(FileOf(store, files[3].digest), 0);
  using State = HeldState;
  EXPECT_EQ(CheckHeld(store, files, {7}).value(),
            (std::vector{State::kKept, State::kLost, State::kKept, State::kKept, State::kLost}));
  EXPECT_EQ(fs::file_size(FileOf(store, files[3].digest)), 12u) << "fetched anew";
  EXPECT_EQ(Query(store, "SELECT 1 FROM waiting_blob WHERE digest = ?").Bind(files[1].digest).Step(), true);
}

TEST_F(StoreBucketTest, WhatABucketOutOfReachHasIsNotLost) {
  Store store = OpenStore();
  const Digest digest = AppendBlob(store.blobs(), "picture").value();
  ASSERT_TRUE(fs::remove(FileOf(store, digest)));
  const Variable endpoint("AWS_ENDPOINT_URL_S3", "http://127.0.0.1:1");
  Store cut_off = OpenStore();
  EXPECT_EQ(CheckHeld(cut_off, {{digest, 7}}, {7}).value(), std::vector{HeldState::kUnknown});
}

// A first try that failed has left the file in the folder: it is not taken for what the bucket has.
TEST_F(StoreBucketTest, WhatWasNotPutBeforeIsPutNow) {
  const Store store = OpenStore();
  ASSERT_TRUE(AppendBlob(store.BlobFolder(), "picture")) << "the folder alone";
  const Digest digest = AppendBlob(store.blobs(), "picture").value();
  EXPECT_TRUE(store.blobs().bucket()->Has(digest).value());
}

TEST_F(StoreBucketTest, AnotherBucketIsRefused) {
  static_cast<void>(OpenStore());
  const auto other = Store::Open(At("one", place_ + "-other"));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kConflict);
  EXPECT_NE(other.error().what.find(" are in " + place_ + ", not in " + place_ + "-other"), std::string::npos)
      << other.error().what;
  EXPECT_EQ(other.error().cure, "Give --blobs " + place_ + ".");
}

TEST_F(StoreBucketTest, WithoutItsBucketNothingIsConcludedOfItsFiles) {
  static_cast<void>(OpenStore());
  auto store = Store::Open(At("one", ""));
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_EQ(CheckBlobs(*store).error().code, ErrorCode::kConflict);
  EXPECT_EQ(LookAtBlob(store->blobs(), DigestOf("a")).error().cure, "Give --blobs " + place_ + ".");
  EXPECT_FALSE(AppendBlob(store->blobs(), "a"));
  EXPECT_FALSE(AdoptBlobs(store->blobs(), {}));
}

TEST_F(StoreBucketTest, TheBucketOfAnotherStoreIsRefused) {
  static_cast<void>(OpenStore());
  const TempFolder elsewhere;
  const TempDatabase another(elsewhere.path());
  StorePlace place = another.In(elsewhere.path() / "two");
  place.bucket = place_;
  const auto store = Store::Open(place);
  ASSERT_FALSE(store);
  EXPECT_NE(store.error().what.find("is that of another store"), std::string::npos) << WordsOf(store);
}

TEST_F(StoreBucketTest, WhatAFolderHasIsPutThereWhenTheStoreBegins) {
  Digest good, damaged;
  {
    const auto store = Store::Open(At("one", ""));
    ASSERT_TRUE(store);
    good = AppendBlob(store->blobs(), "good").value();
    damaged = AppendBlob(store->blobs(), "damaged").value();
    fs::resize_file(FileOf(*store, damaged), 2);
  }
  Store store = OpenStore();
  EXPECT_TRUE(CheckBlobs(store));
  EXPECT_TRUE(store.blobs().bucket()->Has(good).value());
  EXPECT_FALSE(store.blobs().bucket()->Has(damaged).value());
}

TEST_F(StoreBucketTest, WhatAFolderHadLostIsNotTakenForHeld) {
  Digest damaged, missing;
  {
    auto store = Store::Open(At("one", ""));
    ASSERT_TRUE(store);
    damaged = AppendBlob(store->blobs(), "damaged").value();
    missing = DigestOf("missing");
    fs::resize_file(FileOf(*store, damaged), 2);
    NoteHeld(*store, damaged);
    NoteHeld(*store, missing);
    NoteHeld(*store, AppendBlob(store->blobs(), "good").value());
  }
  Store store = OpenStore();
  EXPECT_FALSE(IsHeld(store, RobotId("r"), damaged).value());
  EXPECT_FALSE(IsHeld(store, RobotId("r"), missing).value());
  EXPECT_TRUE(IsHeld(store, RobotId("r"), DigestOf("good")).value());
}

TEST_F(StoreBucketTest, AFileThatCannotBeReadEndsTheBegin) {
  Digest digest;
  {
    const auto store = Store::Open(At("one", ""));
    ASSERT_TRUE(store);
    digest = DigestOf("a");
    ASSERT_TRUE(fs::create_directory(FileOf(*store, digest)));
  }
  const fs::path file = BlobPath(folder_.path() / "one" / "blobs", digest);
  const auto failed = TryOpen();
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().what.find(digest.str()), std::string::npos) << WordsOf(failed);
  auto without = Store::Open(At("one", ""));
  ASSERT_TRUE(without);
  EXPECT_EQ(CheckBlobs(*without).error().code, ErrorCode::kConflict) << "its files are on their way";
  ASSERT_TRUE(fs::remove(file));
  const auto again = TryOpen();
  EXPECT_TRUE(again) << WordsOf(again) << ": goes on";
}

// Killed after the bucket was told whose it is, and before the rows were.
TEST_F(StoreBucketTest, AnOwnerThatIsThisStoreIsNoOther) {
  {
    auto store = Store::Open(At("one", ""));
    ASSERT_TRUE(store);
    Query(*store, "INSERT INTO lease_bucket_begun VALUES (?, 'id')").Bind(place_).Run();
  }
  ASSERT_TRUE(Open(place_)->PutOwner("id"));
  const auto store = TryOpen();
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_EQ(store->blobs().store_id(), "id");
}

// It runs on after another process has begun the bucket.
TEST_F(StoreBucketTest, WhoDoesNotKnowOfTheBucketAddsNothing) {
  auto before = Store::Open(At("one", ""));
  ASSERT_TRUE(before);
  EXPECT_TRUE(CheckBlobsStayed(*before));
  Store store = OpenStore();
  EXPECT_TRUE(CheckBlobsStayed(store));
  EXPECT_EQ(CheckBlobsStayed(*before).error().code, ErrorCode::kUnreachable);
}

TEST_F(StoreBucketTest, ABucketThatIsNotTheStoresAnyMoreTellsOfNoLoss) {
  const Store store = OpenStore();
  ASSERT_TRUE(Open(place_)->PutOwner("of another"));
  EXPECT_EQ(LookAtBlob(store.blobs(), DigestOf("a")).error().code, ErrorCode::kUnreachable);
}

TEST_F(StoreBucketTest, OthersAtWorkAreRefused) {
  if (IsOnSqlite()) GTEST_SKIP() << "for PostgreSQL";
  auto before = Store::Open(At("one", ""));
  ASSERT_TRUE(before);
  ASSERT_TRUE(AppendServer(*before, {"another", {}}, kServerTime));
  const auto refused = TryOpen();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict) << WordsOf(refused);
  EXPECT_TRUE(CheckBlobsStayed(*before)) << "nothing has begun";
  ASSERT_TRUE(RemoveServer(*before, "another"));
  EXPECT_TRUE(TryOpen());
}

TEST_F(StoreBucketTest, AnEmptyFolderDoesNotBeginTheBucket) {
  if (IsOnSqlite()) GTEST_SKIP() << "for PostgreSQL";
  Digest digest;
  {
    const auto store = Store::Open(At("one", ""));
    ASSERT_TRUE(store);
    digest = AppendBlob(store->blobs(), "picture").value();
  }
  const auto empty = TryOpen("two");
  ASSERT_FALSE(empty);
  EXPECT_NE(empty.error().what.find("is new to the store"), std::string::npos) << WordsOf(empty);
  const Store one = OpenStore("one"), two = OpenStore("two");
  EXPECT_EQ(LoadBlob(two.blobs(), digest, kBytesMax).value(), "picture");
}

// On PostgreSQL every process may have a folder of its own; on SQLite the folder has the rows.
TEST_F(StoreBucketTest, AnotherFolderIsOneOfTheStores) {
  if (IsOnSqlite()) GTEST_SKIP() << "for PostgreSQL";
  const Store one = OpenStore("one"), two = OpenStore("two");
  const Digest digest = AppendBlob(one.blobs(), "picture").value();
  EXPECT_EQ(LoadBlob(two.blobs(), digest, kBytesMax).value(), "picture");
  ASSERT_TRUE(fs::create_directory(folder_.path() / "three"));
  ASSERT_TRUE(WriteDurably(folder_.path() / "three" / "store-id", "of another store\n"));
  const auto three = TryOpen("three");
  ASSERT_FALSE(three);
  EXPECT_EQ(three.error().code, ErrorCode::kConflict);
}

}  // namespace
}  // namespace rigcal::storage
