// Contents in a bucket of a real S3 service (tests/s3/with_s3).
#include "storage/s3/bucket.h"

#include <signal.h>

#include <chrono>
#include <new>

#include "server/base/files/durable_file.h"
#include "tests/unit/storage/s3/fixture.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kBytesMax = 16 << 20;

class BucketTest : public BucketFixture {};

TEST_F(BucketTest, GivesWhatWasPut) {
  const auto bucket = Open(place_);
  const std::string bytes("a picture\0with a zero", 21);
  const Digest digest = Sha256Of(bytes);
  EXPECT_FALSE(bucket->Has(digest).value());
  EXPECT_EQ(Got(*bucket, digest, kBytesMax).value(), std::nullopt);
  for (int i = 0; i < 2; ++i) {
    const Status put = bucket->Put(digest, std::string_view(bytes));
    ASSERT_TRUE(put) << WordsOf(put);
  }
  EXPECT_TRUE(bucket->Has(digest).value());
  EXPECT_EQ(Got(*bucket, digest, kBytesMax).value(), bytes);
}

TEST_F(BucketTest, PutsFilesOfAnySize) {
  const auto bucket = Open(place_);
  for (const std::size_t size : {0u, 1u, 3u << 20}) {
    const std::string bytes(size, 'x');
    const std::filesystem::path file = folder_.path() / "file";
    ASSERT_TRUE(WriteDurably(file, bytes));
    const Status put = bucket->Put(Sha256Of(bytes), file);
    ASSERT_TRUE(put) << size << " " << WordsOf(put);
    EXPECT_EQ(Got(*bucket, Sha256Of(bytes), kBytesMax).value(), bytes) << size;
  }
}

TEST_F(BucketTest, TheServiceHoldsWhatItReceivesAgainstTheDigest) {
  const auto bucket = Open(place_);
  const Digest digest = DigestOf("what it should be");
  const Status put = bucket->Put(digest, std::string_view("what became of it"));
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().code, ErrorCode::kStorage) << WordsOf(put);
  EXPECT_FALSE(bucket->Has(digest).value());
}

TEST_F(BucketTest, WhatIsGotIsNoMoreThanAskedFor) {
  const auto bucket = Open(place_);
  const std::string bytes(1 << 20, 'y');
  ASSERT_TRUE(bucket->Put(Sha256Of(bytes), std::string_view(bytes)));
  const auto got = Got(*bucket, Sha256Of(bytes), 1000);
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().code, ErrorCode::kStorage) << "not: it is out of reach";
}

// A robot's file that this disk cannot give holds up nobody else.
TEST_F(BucketTest, AFileThatCannotBeReadIsNoBucketOutOfReach) {
  const auto bucket = Open(place_);
  const Status missing = bucket->Put(DigestOf("a"), folder_.path() / "missing");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kStorage) << WordsOf(missing);
  EXPECT_TRUE(bucket->Put(DigestOf("a"), std::string_view("a"))) << "at once";
}

TEST_F(BucketTest, WhatCannotBeTakenIsNoBucketOutOfReach) {
  const auto bucket = Open(place_);
  ASSERT_TRUE(bucket->Put(DigestOf("a"), std::string_view("a")));
  const auto full = [](std::int64_t, std::string_view) { return Status(Fail(ErrorCode::kStorage, "disk full", "")); };
  const auto got = bucket->Get(DigestOf("a"), kBytesMax, full);
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().code, ErrorCode::kStorage) << WordsOf(got);
  EXPECT_NE(got.error().what.find("disk full"), std::string::npos) << WordsOf(got);
  const auto throws = [](std::int64_t, std::string_view) -> Status { throw std::bad_alloc(); };
  EXPECT_EQ(bucket->Get(DigestOf("a"), kBytesMax, throws).error().code, ErrorCode::kStorage);
  EXPECT_EQ(Got(*bucket, DigestOf("a"), kBytesMax).value(), "a");
}

TEST_F(BucketTest, AWrongSecretIsSaidWithItsCure) {
  const Variable secret("AWS_SECRET_ACCESS_KEY", "not-the-secret");
  const auto bucket = Open(place_);
  const Status checked = bucket->Check("id");
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Sentence(checked.error()),
            "the bucket " + bucket->name() +
                " does not accept the key: the secret is wrong (HTTP status 403, SignatureDoesNotMatch). Mend "
                "AWS_SECRET_ACCESS_KEY, or the file of AWS_SHARED_CREDENTIALS_FILE.");
  EXPECT_EQ(bucket->Put(DigestOf("a"), std::string_view("a")).error().code, ErrorCode::kUnreachable);
  EXPECT_EQ(bucket->Has(DigestOf("a")).error().code, ErrorCode::kUnreachable);
}

TEST_F(BucketTest, AnUnknownKeyIsRefused) {
  const Variable id("AWS_ACCESS_KEY_ID", "NOBODY");
  EXPECT_EQ(Open(place_)->Check("id").error().code, ErrorCode::kInvalidInput);
}

TEST_F(BucketTest, AMissingBucketIsSaidWithItsCure) {
  const auto bucket = Open("s3://no-such-bucket/a");
  EXPECT_EQ(Sentence(bucket->Check("id").error()),
            "the bucket " + bucket->name() +
                " does not exist (HTTP status 404, NoSuchBucket). Make the bucket, or mend --blobs and "
                "AWS_ENDPOINT_URL_S3.");
  EXPECT_EQ(Got(*bucket, DigestOf("a"), kBytesMax).error().code, ErrorCode::kUnreachable) << "not: it is lost";
}

TEST_F(BucketTest, KnowsWhoseItIs) {
  const auto bucket = Open(place_);
  EXPECT_EQ(bucket->LoadOwner().value(), "");
  EXPECT_EQ(bucket->Check("mine").error().code, ErrorCode::kConflict);
  ASSERT_TRUE(bucket->PutOwner("mine"));
  const Status checked = bucket->Check("mine");
  EXPECT_TRUE(checked) << WordsOf(checked);
  EXPECT_EQ(bucket->Check("another").error().code, ErrorCode::kConflict);
}

TEST_F(BucketTest, WhereNobodyListensItIsSaid) {
  const Variable endpoint("AWS_ENDPOINT_URL_S3", "http://127.0.0.1:1");
  const auto bucket = Open(place_);
  const Status put = bucket->Put(DigestOf("a"), std::string_view("a"));
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().code, ErrorCode::kUnreachable);
  EXPECT_EQ(put.error().what, "the bucket " + bucket->name() + " cannot be reached: Couldn't connect to server");
  EXPECT_NE(bucket->name().find("127.0.0.1:1"), std::string::npos);
}

TEST_F(BucketTest, AServiceThatStandsStillIsGivenUpAndUsedAgain) {
  const auto server = static_cast<pid_t>(std::stol(std::getenv("RIGCAL_TEST_S3_PID")));
  const auto bucket = Open(place_);
  const std::string bytes(4 << 20, 'z');
  ASSERT_EQ(kill(server, SIGSTOP), 0);
  const Status put = bucket->Put(Sha256Of(bytes), std::string_view(bytes));
  ASSERT_EQ(kill(server, SIGCONT), 0);
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().code, ErrorCode::kUnreachable) << WordsOf(put);
  EXPECT_NE(bucket->Has(Sha256Of(bytes)).error().what.find("cannot be reached"), std::string::npos) << "left alone";
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  Status again = put;
  while (!again && std::chrono::steady_clock::now() < until)
    again = bucket->Put(Sha256Of(bytes), std::string_view(bytes));
  ASSERT_TRUE(again) << WordsOf(again);
  EXPECT_EQ(Got(*bucket, Sha256Of(bytes), kBytesMax).value(), bytes);
}

}  // namespace
}  // namespace rigcal::storage
