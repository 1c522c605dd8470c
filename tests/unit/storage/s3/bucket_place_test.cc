// What --blobs and the environment say, read without asking anybody.
#include "storage/s3/bucket_place.h"

#include <sys/stat.h>

#include "server/base/files/durable_file.h"
#include "tests/unit/storage/s3/fixture.h"

namespace rigcal::storage {
namespace {

TEST(BucketPlaceTest, NamesBucketPrefixAndHost) {
  const Variable endpoint("AWS_ENDPOINT_URL_S3", "https://s3.example.org:9000/"), region("AWS_REGION", "eu-north-1");
  const BucketPlace place = ReadBucketPlace("s3://rigs/site-1/b").value();
  EXPECT_EQ(place.bucket + " " + place.prefix + " " + place.region, "rigs site-1/b eu-north-1");
  EXPECT_EQ(NameOf(place), "s3://rigs/site-1/b at s3.example.org:9000");
  EXPECT_EQ(NameOf(ReadBucketPlace("s3://rigs").value()), "s3://rigs at s3.example.org:9000");
}

TEST(BucketPlaceTest, WithoutAnAddressItIsAmazons) {
  const Variable endpoint("AWS_ENDPOINT_URL_S3", ""), region("AWS_REGION", "");
  EXPECT_EQ(ReadBucketPlace("s3://rigs").value().endpoint, "https://s3.us-east-1.amazonaws.com");
}

TEST(BucketPlaceTest, WhatIsNoBucketIsRefusedWithoutRepeatingIt) {
  for (const char* text : {"", "rigs", "s3://", "s3://ab", "s3://Rigs", "s3://rigs/", "s3://rigs//a", "s3://rigs/../a",
                           "s3://rigs/a b", "s3://key:secret@rigs", "https://rigs", "s3://rigs/a%20b"}) {
    const auto place = ReadBucketPlace(text);
    ASSERT_FALSE(place) << text;
    EXPECT_EQ(place.error().code, ErrorCode::kInvalidInput);
    EXPECT_EQ(Sentence(place.error()).find("secret"), std::string::npos) << Sentence(place.error());
  }
}

TEST(BucketPlaceTest, AnAddressHasNoPathAndNoUser) {
  for (const char* text : {"s3.example.org", "ftp://s3.example.org", "https://", "https://u:p@s3.example.org",
                           "https://s3.example.org/rigs", "https://s3.example.org?x"}) {
    const Variable endpoint("AWS_ENDPOINT_URL_S3", text);
    EXPECT_FALSE(ReadBucketPlace("s3://rigs")) << text;
  }
}

TEST(BucketPlaceTest, PlainHttpStaysOnThisMachine) {
  for (const char* here : {"http://127.0.0.1:9000", "http://localhost:9000", "http://[::1]:9000"}) {
    const Variable endpoint("AWS_ENDPOINT_URL_S3", here);
    EXPECT_TRUE(ReadBucketPlace("s3://rigs")) << here;
  }
  for (const char* there : {"http://s3.example.org", "http://127.0.0.1.example.org", "http://localhost.example.org"}) {
    const Variable endpoint("AWS_ENDPOINT_URL_S3", there);
    EXPECT_FALSE(ReadBucketPlace("s3://rigs")) << there;
    const Variable open("RIGCAL_BLOBS_HTTP", "open");
    EXPECT_TRUE(ReadBucketPlace("s3://rigs")) << there;
  }
}

class BucketKeysTest : public testing::Test {
 protected:
  void Write(const std::string& text, mode_t mode = 0600) {
    ASSERT_TRUE(WriteDurably(path_, text));
    ASSERT_EQ(chmod(path_.c_str(), mode), 0);
  }

  TempFolder folder_;
  std::filesystem::path path_ = folder_.path() / "keys";
  Variable file_{"AWS_SHARED_CREDENTIALS_FILE", path_.string()}, id_{"AWS_ACCESS_KEY_ID", ""};
  Variable secret_{"AWS_SECRET_ACCESS_KEY", ""}, token_{"AWS_SESSION_TOKEN", ""}, profile_{"AWS_PROFILE", ""};
};

TEST_F(BucketKeysTest, ComeFromTheEnvironmentFirst) {
  Write("aws_access_key_id = f\naws_secret_access_key = g\n");
  const Variable id("AWS_ACCESS_KEY_ID", "a"), secret("AWS_SECRET_ACCESS_KEY", "b"), token("AWS_SESSION_TOKEN", "c");
  const BucketKeys keys = FindBucketKeys().value();
  EXPECT_EQ(keys.id + keys.secret + keys.session_token, "abc");
}

TEST_F(BucketKeysTest, ComeFromThePartOfAFile) {
  Write(
      "[other]\naws_access_key_id=x\n[default]\naws_access_key_id = a\r\n aws_secret_access_key=b=\n[last]\n"
      "aws_secret_access_key = y\n");
  EXPECT_EQ(FindBucketKeys().value().id + FindBucketKeys().value().secret, "ab=");
  const Variable profile("AWS_PROFILE", "last");
  EXPECT_FALSE(FindBucketKeys()) << "a secret alone";
}

TEST_F(BucketKeysTest, AFileThatOthersMayReadIsRefused) {
  Write("aws_access_key_id = a\naws_secret_access_key = hidden\n", 0640);
  const auto keys = FindBucketKeys();
  ASSERT_FALSE(keys);
  EXPECT_EQ(Sentence(keys.error()), "others on this machine may read the key in " + path_.string() + ". `chmod 600 " +
                                        path_.string() + "` ends that.");
}

TEST_F(BucketKeysTest, NoneAreMissedByName) {
  const Variable file("AWS_SHARED_CREDENTIALS_FILE", "");
  EXPECT_EQ(FindBucketKeys().error().what, "there is no key for the bucket of --blobs");
}

}  // namespace
}  // namespace rigcal::storage
