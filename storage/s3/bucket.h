// Contents in a bucket of an S3 service, by their digests: PREFIX/ab/abcdef..., as in a blob folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "storage/s3/s3_link.h"

namespace rigcal::storage {

// A content is put by one request, so it may have 5 GB (limits::kPayloadBytesMax is less). What fails for the moment
// (no answer, HTTP 429 or 5xx) is tried three times, for about ten seconds; where no answer came nobody of this process
// asks for the next five. kUnreachable: it was not done, and may be
// later: names bucket, host, why and the cure. kStorage: the service does not take this one. Any thread.
class Bucket {
 public:
  // Of `place`, "s3://BUCKET/PREFIX", by the environment (bucket_place.h). Asks nobody.
  [[nodiscard]] static Result<std::shared_ptr<const Bucket>> Open(const std::string& place);

  // "s3://BUCKET/PREFIX at HOST".
  [[nodiscard]] std::string name() const { return NameOf(link_.place()); }
  [[nodiscard]] Result<bool> Has(const Digest& digest) const;
  // The same, and in that length, where the service tells one.
  [[nodiscard]] Result<bool> Has(const Digest& digest, std::int64_t size_bytes) const;
  // Durable when it returns: the service has held what it received against the digest. A repeat is a no-op, and mends
  // what the service has damaged.
  [[nodiscard]] Status Put(const Digest& digest, const std::filesystem::path& file) const;
  [[nodiscard]] Status Put(const Digest& digest, std::string_view bytes) const;
  // As the service has them: not held against the digest. False: the service says that there is no such object, of
  // whatever bucket answers there (CheckOwner). kStorage: `take` did not take them, or there are more than `bytes_max`.
  [[nodiscard]] Result<bool> Get(const Digest& digest, std::size_t bytes_max, const TakeContent& take) const;

  // Which store the bucket and prefix belong to, told by an object rigcal-store; empty: to none yet.
  [[nodiscard]] Result<std::string> LoadOwner() const;
  // Makes them that store's.
  [[nodiscard]] Status PutOwner(const std::string& store_id) const;
  // kConflict: they are not `store_id`'s.
  [[nodiscard]] Status CheckOwner(const std::string& store_id) const;
  // Whether the store can work with it: it is there, belongs to `store_id`, and lets us write, read and tell what is
  // not there. Writes only where nothing was put since the process began, or the last put failed. kInvalidInput or
  // kConflict, where a person has to do something about it; kUnreachable where it may pass.
  [[nodiscard]] Status Check(const std::string& store_id) const;

 private:
  struct Seen;  // by all of a process that use the same bucket
  Bucket(BucketPlace place, BucketKeys keys);
  [[nodiscard]] static Seen& SeenOf(const BucketPlace& place);
  [[nodiscard]] std::string ObjectOf(const std::string& name) const;
  [[nodiscard]] std::string ObjectOf(const Digest& digest) const;
  [[nodiscard]] S3Answer Ask(const S3Request& request) const;
  [[nodiscard]] Result<S3Answer> AskFor(const Digest& digest) const;
  [[nodiscard]] Error ErrorOf(const S3Answer& answer) const;
  [[nodiscard]] Status PutObject(const S3Request& request) const;
  [[nodiscard]] Result<std::optional<std::string>> GetObject(const std::string& object, std::size_t bytes_max) const;

  const S3Link link_;
  Seen& seen_;
};

}  // namespace rigcal::storage
