// Where a bucket is and who may use it: what --blobs and the environment say, in the words of AWS's own tools.
#pragma once

#include <string>

#include "server/base/result.h"

namespace rigcal::storage {

struct BucketPlace {
  std::string bucket;
  std::string prefix;    // of the names of all objects, without slashes at its ends; empty: none
  std::string endpoint;  // "https://s3.eu-central-1.amazonaws.com"
  std::string region;
};
// "s3://BUCKET" or "s3://BUCKET/PREFIX", at AWS_ENDPOINT_URL_S3 (not set: Amazon's) in AWS_REGION (us-east-1).
// kInvalidInput for anything else, a user or a secret in it, say.
[[nodiscard]] Result<BucketPlace> ReadBucketPlace(const std::string& text);
// "s3://BUCKET/PREFIX at HOST".
[[nodiscard]] std::string NameOf(const BucketPlace& place);
[[nodiscard]] std::string HostOf(const BucketPlace& place);

struct BucketKeys {
  std::string id, secret;
  std::string session_token;  // empty: none
};
// AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and AWS_SESSION_TOKEN; or else the lines aws_access_key_id = ... of
// AWS_SHARED_CREDENTIALS_FILE, of the part [default] or [AWS_PROFILE]. kInvalidInput where there are none, or others on
// this machine may read the file.
[[nodiscard]] Result<BucketKeys> FindBucketKeys();

}  // namespace rigcal::storage
