#include "storage/s3/bucket_place.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "server/base/files/durable_file.h"
#include "server/base/text.h"

namespace rigcal::storage {
namespace {

constexpr std::string_view kS3Scheme = "s3://", kLower = "abcdefghijklmnopqrstuvwxyz0123456789.-";
constexpr std::string_view kInPrefix = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/";
constexpr std::size_t kBucketNameMin = 3, kBucketNameMax = 63, kPrefixMax = 512, kKeyFileBytesMax = 64 << 10;

std::string FromEnvironment(const char* variable, const std::string& otherwise = "") {
  const char* const text = std::getenv(variable);
  return text != nullptr && *text != 0 ? text : otherwise;
}

bool IsBucketName(const std::string& name) {
  return name.size() >= kBucketNameMin && name.size() <= kBucketNameMax &&
         name.find_first_not_of(kLower) == std::string::npos && name.front() != '.' && name.front() != '-';
}

// Of what needs no escapes in an address, and has one meaning there.
bool IsPrefix(const std::string& prefix) {
  return prefix.size() <= kPrefixMax && prefix.find_first_not_of(kInPrefix) == std::string::npos &&
         prefix.find("//") == std::string::npos && prefix.find("./") == std::string::npos &&
         (prefix.empty() || (prefix.front() != '/' && prefix.back() != '/' && prefix.back() != '.'));
}

// Without a path: what is in it would be a part of names.
bool IsEndpoint(const std::string& endpoint) {
  const std::size_t scheme = endpoint.rfind("https://", 0) == 0 ? 8 : endpoint.rfind("http://", 0) == 0 ? 7 : 0;
  return scheme != 0 && endpoint.size() > scheme && endpoint.find_first_of("/@?# \t\r\n", scheme) == std::string::npos;
}

// Whoever is on the way reads files and their signatures.
bool IsPlainBeyondThisMachine(const std::string& endpoint) {
  constexpr std::string_view kPlain = "http://";
  if (endpoint.rfind(kPlain, 0) != 0) return false;
  const std::string host = endpoint.substr(kPlain.size());
  const std::string name = host.substr(0, host.front() == '[' ? host.find(']') + 1 : host.find(':'));
  const bool is_here = name == "localhost" || name == "[::1]" ||
                       (name.rfind("127.", 0) == 0 && name.find_first_not_of("0123456789.") == std::string::npos);
  return !is_here && FromEnvironment("RIGCAL_BLOBS_HTTP") != "open";
}

std::string Trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

void TakeKeyLine(const std::string& line, BucketKeys& keys) {
  const std::size_t sign = line.find('=');
  if (sign == std::string::npos) return;
  const std::string name = Trimmed(line.substr(0, sign)), value = Trimmed(line.substr(sign + 1));
  if (name == "aws_access_key_id") keys.id = value;
  if (name == "aws_secret_access_key") keys.secret = value;
  if (name == "aws_session_token") keys.session_token = value;
}

Status RefuseReadableByOthers(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0 || (status.st_mode & 077) == 0) return {};
  return Fail(ErrorCode::kInvalidInput, "others on this machine may read the key in " + file,
              "`chmod 600 " + file + "` ends that.");
}

Result<BucketKeys> KeysInFile(const std::string& file) {
  RIGCAL_TRY(RefuseReadableByOthers(file));
  RIGCAL_ASSIGN(const std::string text, ReadFile(file, kKeyFileBytesMax));
  const std::string wanted = "[" + FromEnvironment("AWS_PROFILE", "default") + "]";
  BucketKeys keys;
  bool is_wanted = true;  // also without parts
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line = Trimmed(line);
    if (!line.empty() && line.front() == '[')
      is_wanted = line == wanted;
    else if (is_wanted)
      TakeKeyLine(line, keys);
  }
  return keys;
}

}  // namespace

Result<BucketPlace> ReadBucketPlace(const std::string& text) {
  BucketPlace place;
  const bool is_s3 = text.rfind(kS3Scheme, 0) == 0;
  const std::string rest = is_s3 ? text.substr(kS3Scheme.size()) : "";
  const std::size_t slash = rest.find('/');
  place.bucket = rest.substr(0, slash);
  place.prefix = slash == std::string::npos ? "" : rest.substr(slash + 1);
  const bool ends_in_slash = slash != std::string::npos && place.prefix.empty();
  if (!IsBucketName(place.bucket) || !IsPrefix(place.prefix) || ends_in_slash)
    return Fail(ErrorCode::kInvalidInput, "--blobs is not s3://BUCKET or s3://BUCKET/PREFIX",
                "Write, for instance, s3://rigs/site-1, of letters, digits and . _ - alone; keys do not belong there.");
  place.region = FromEnvironment("AWS_REGION", "us-east-1");
  if (place.region.find_first_not_of(kLower) != std::string::npos)
    return Fail(ErrorCode::kInvalidInput, "AWS_REGION is no region", "Write, for instance, eu-central-1.");
  place.endpoint = FromEnvironment("AWS_ENDPOINT_URL_S3", "https://s3." + place.region + ".amazonaws.com");
  if (place.endpoint.back() == '/') place.endpoint.pop_back();
  if (!IsEndpoint(place.endpoint))
    return Fail(ErrorCode::kInvalidInput, "AWS_ENDPOINT_URL_S3 is no address of a server",
                "Write, for instance, https://s3.example.org, without a path.");
  if (IsPlainBeyondThisMachine(place.endpoint))
    return Fail(ErrorCode::kInvalidInput, "AWS_ENDPOINT_URL_S3 is http:// to another machine, which nothing protects",
                "Give its https:// address; or set RIGCAL_BLOBS_HTTP=open where the network is trusted.");
  return place;
}

std::string HostOf(const BucketPlace& place) { return place.endpoint.substr(place.endpoint.find("://") + 3); }

std::string NameOf(const BucketPlace& place) {
  return std::string(kS3Scheme) + place.bucket + (place.prefix.empty() ? "" : "/" + place.prefix) + " at " +
         HostOf(place);
}

Result<BucketKeys> FindBucketKeys() {
  BucketKeys keys{FromEnvironment("AWS_ACCESS_KEY_ID"), FromEnvironment("AWS_SECRET_ACCESS_KEY"),
                  FromEnvironment("AWS_SESSION_TOKEN")};
  const std::string file = FromEnvironment("AWS_SHARED_CREDENTIALS_FILE");
  if (keys.id.empty() && !file.empty()) {
    RIGCAL_ASSIGN(keys, KeysInFile(file));
  }
  if (!keys.id.empty() && !keys.secret.empty()) return keys;
  return Fail(ErrorCode::kInvalidInput, "there is no key for the bucket of --blobs",
              "Set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_SHARED_CREDENTIALS_FILE to a file with both.");
}

}  // namespace rigcal::storage
