// Where the S3 server of tests/s3/with_s3 is, and a prefix of each test's own in its bucket.
#pragma once

#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include "storage/s3/bucket.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {

// Sets a variable of the environment while it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Variable() {
    if (before_)
      setenv(name_, before_->c_str(), 1);
    else
      unsetenv(name_);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

inline std::string TestBucket() {
  const char* bucket = std::getenv("RIGCAL_TEST_BUCKET");
  return bucket == nullptr ? "" : bucket;
}

class BucketFixture : public testing::Test {
 protected:
  void SetUp() override {
    if (TestBucket().empty()) GTEST_SKIP() << "no S3 server: run it with tests/s3/with_s3";
  }

  static std::shared_ptr<const Bucket> Open(const std::string& place) {
    auto bucket = Bucket::Open(place);
    if (!bucket) throw std::runtime_error(WordsOf(bucket));
    return *bucket;
  }

  [[nodiscard]] static Result<std::optional<std::string>> Got(const Bucket& bucket, const Digest& digest,
                                                              std::size_t bytes_max) {
    std::string got;
    const auto take = [&](std::int64_t at, std::string_view bytes) -> Status {
      got.resize(static_cast<std::size_t>(at));
      got += bytes;
      return {};
    };
    RIGCAL_ASSIGN(const bool is_there, bucket.Get(digest, bytes_max, take));
    return is_there ? std::optional(got) : std::nullopt;
  }

  // What the service has under that name is these bytes from now on.
  [[nodiscard]] static S3Answer Replace(const std::string& place, const Digest& digest, const std::string& bytes) {
    const BucketPlace read = ReadBucketPlace(place).value();
    const S3Link link(read, FindBucketKeys().value());
    const std::string object = read.prefix + "/" + digest.str().substr(0, 2) + "/" + digest.str();
    return link.Ask(
        {.kind = S3Request::Kind::kPut, .object = object, .digest = Sha256Of(bytes), .file = {}, .bytes = bytes});
  }

  TempFolder folder_;
  const std::string place_ = "s3://" + TestBucket() + "/" + folder_.path().filename().string();
};

}  // namespace rigcal::storage
