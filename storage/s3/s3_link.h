// One request to an S3 server, signed (version 4 of AWS's signatures, by libcurl), and what it answered.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "storage/s3/bucket_place.h"

namespace rigcal::storage {

// Of a content that is got, the bytes that begin at `at`, in their order; 0: it begins, also once more.
using TakeContent = std::function<Status(std::int64_t at, std::string_view bytes)>;

struct S3Request {
  enum class Kind { kHead, kGet, kPut };
  Kind kind = Kind::kGet;
  std::string object;               // below the bucket
  std::size_t bytes_max = 0;        // of what is got
  Digest digest = {};               // of what is put: the server holds what it received against it
  std::filesystem::path file = {};  // what is put; empty: `bytes`
  std::string_view bytes = {};      // likewise
  TakeContent take = {};            // of what is got; empty: it is the answer's body
};

struct S3Answer {
  int status = 0;                // of HTTP; 0: no whole answer came
  std::string body;              // of what is got, or the server's XML of what is wrong
  std::string why;               // no whole answer came
  bool is_ours = false;          // `why` is of this machine: its disk, or what came was more than it takes
  std::int64_t size_bytes = -1;  // of what is asked for by kHead; -1: it was not told
};

// Connections that wait are used again. Any thread.
class S3Link {
 public:
  S3Link(BucketPlace place, BucketKeys keys) : place_(std::move(place)), keys_(std::move(keys)) {}
  ~S3Link();
  S3Link(const S3Link&) = delete;
  S3Link& operator=(const S3Link&) = delete;

  [[nodiscard]] const BucketPlace& place() const { return place_; }
  // Once: nothing is tried again. Gives up where no connection is made within 5 s, hardly a byte moves for 10 s, or
  // the whole takes longer than a minute and 16 KiB/s.
  [[nodiscard]] S3Answer Ask(const S3Request& request) const;

 private:
  class Turn;

  const BucketPlace place_;
  const BucketKeys keys_;
  mutable std::mutex mutex_;
  mutable std::vector<void*> idle_;  // handles of libcurl
};

}  // namespace rigcal::storage
