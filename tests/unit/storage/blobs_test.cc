#include "storage/files/blobs.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class BlobsTest : public StoreTest {
 protected:
  fs::path blobs_ = store_.BlobFolder();

  FinishedFile Finished(const std::string& name, const std::string& bytes) {
    const fs::path path = store_.IntakeFolder() / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return {path, DigestOf(bytes)};
  }
};

TEST_F(BlobsTest, AnAppendedBlobComesBackUnderItsDigest) {
  const std::string bytes("a\0b\xff", 4);
  EXPECT_FALSE(HasBlob(blobs_, DigestOf(bytes)));
  const Result<Digest> digest = AppendBlob(blobs_, bytes);
  ASSERT_TRUE(digest) << WordsOf(digest);
  EXPECT_EQ(digest->str().substr(0, 2), BlobPath(blobs_, *digest).parent_path().filename().string());
  EXPECT_TRUE(HasBlob(blobs_, *digest));
  EXPECT_EQ(LoadBlob(blobs_, *digest, 4).value(), bytes);
  EXPECT_TRUE(AppendBlob(blobs_, bytes));
}

// The digest of "abc" in FIPS 180-2, appendix B.1.
TEST_F(BlobsTest, TheNameIsTheSha256OfTheContent) {
  ASSERT_TRUE(AppendBlob(blobs_, "abc"));
  EXPECT_TRUE(fs::exists(blobs_ / "ba" / "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"));
}

TEST_F(BlobsTest, ALargerBlobThanAskedForIsRefused) {
  const Digest digest = AppendBlob(blobs_, "12345").value();
  EXPECT_FALSE(LoadBlob(blobs_, digest, 4));
  EXPECT_TRUE(LoadBlob(blobs_, digest, 5));
}

TEST_F(BlobsTest, ABlobThatIsNotThereIsNamed) {
  const Result<std::string> bytes = LoadBlob(blobs_, DigestOf("nothing"), 10);
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(bytes.error().what, HasSubstr(DigestOf("nothing").str()));
  EXPECT_FALSE(LoadBlob(blobs_, Digest("../../etc/passwd"), 10));
  EXPECT_FALSE(HasBlob(blobs_, Digest()));
}

TEST_F(BlobsTest, FinishedFilesMove) {
  const std::vector<FinishedFile> files = {Finished("f1", "one"), Finished("f2", "two"), Finished("f3", "one")};
  const Status done = AdoptBlobs(blobs_, files);
  ASSERT_TRUE(done) << WordsOf(done);
  EXPECT_EQ(LoadBlob(blobs_, DigestOf("one"), 10).value(), "one");
  EXPECT_EQ(LoadBlob(blobs_, DigestOf("two"), 10).value(), "two");
  EXPECT_TRUE(fs::is_empty(store_.IntakeFolder()));
  // Again, as after a crash between the move and its receipt.
  EXPECT_TRUE(AdoptBlobs(blobs_, files));
}

TEST_F(BlobsTest, AFileThatIsGoneIsNamed) {
  const Status done = AdoptBlobs(blobs_, {{store_.IntakeFolder() / "gone", DigestOf("gone")}});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kStorage);
  EXPECT_THAT(done.error().what, HasSubstr("intake/gone"));
}

TEST_F(BlobsTest, AMissingShardIsMade) {
  fs::remove_all(blobs_);
  fs::create_directory(blobs_);
  ASSERT_TRUE(AppendBlob(blobs_, "abc"));
  ASSERT_TRUE(AdoptBlobs(blobs_, {Finished("f1", "one")}));
  EXPECT_TRUE(HasBlob(blobs_, DigestOf("abc")));
  EXPECT_TRUE(HasBlob(blobs_, DigestOf("one")));
}

TEST_F(BlobsTest, ShardsAreNamedInHexadecimal) {
  EXPECT_EQ(ShardFolder("b", 0), fs::path("b/00"));
  EXPECT_EQ(ShardFolder("b", 0xa7), fs::path("b/a7"));
  EXPECT_EQ(ShardFolder("b", 255), fs::path("b/ff"));
}

}  // namespace
}  // namespace rigcal::storage
