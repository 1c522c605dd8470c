#include "client/ask/report_zip.h"

#include <zip.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>

#include "server/base/digests/base64.h"

namespace rigcal::client {
namespace {

constexpr std::int64_t kReportBytesMax = 4LL << 30;
constexpr std::int64_t kFileBytesMax = 1LL << 30;

tl::unexpected<Error> Refused(const std::filesystem::path& file, const std::string& why) {
  return Fail(ErrorCode::kStorage, file.string() + " cannot be written: " + why,
              "Check its folder and the free space.");
}

struct Discard {
  void operator()(zip_t* zip) const { zip_discard(zip); }
};
using Zip = std::unique_ptr<zip_t, Discard>;

Result<Zip> OpenZip(const std::filesystem::path& file) {
  int code = 0;
  Zip zip(zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (zip) return zip;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  return Refused(file, why);
}

Result<std::string> Download(Connection& connection, std::chrono::milliseconds timeout, const std::string& robot,
                             std::int64_t revision, const std::string& path, std::int64_t bytes) {
  std::string contents;
  while (static_cast<std::int64_t>(contents.size()) < bytes) {
    RIGCAL_ASSIGN(const Document piece,
                  connection.AskDocument("report_file",
                                         JsonObject({{"robot", robot},
                                                     {"revision", revision},
                                                     {"path", path},
                                                     {"offset", static_cast<std::int64_t>(contents.size())}}),
                                         timeout));
    RIGCAL_ASSIGN(const std::string part, FromBase64(piece["base64"].Text()));
    if (part.empty() || piece["bytes"].Integer() != bytes)
      return Fail(ErrorCode::kConflict, "the report changed while it was read: " + path, "Run the command again.");
    contents += part;
  }
  return contents;
}

// The zip takes the copy over; a fixed time makes the same report the same file.
Status Add(zip_t* zip, const std::string& name, const std::string& contents, const std::filesystem::path& file) {
  constexpr std::time_t kTime_s = 315'532'800;  // 1980-01-01, the format's first day
  void* copy = std::malloc(std::max<std::size_t>(contents.size(), 1));
  if (copy == nullptr) return Refused(file, "there is too little memory");
  std::memcpy(copy, contents.data(), contents.size());
  zip_source_t* source = zip_source_buffer(zip, copy, contents.size(), 1);
  if (source == nullptr) {
    std::free(copy);
    return Refused(file, zip_strerror(zip));
  }
  const zip_int64_t index = zip_file_add(zip, name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    return Refused(file, zip_strerror(zip));
  }
  zip_file_set_mtime(zip, static_cast<zip_uint64_t>(index), kTime_s, 0);
  return {};
}

bool IsPlainPath(const std::string& path) {
  return !path.empty() && path.front() != '/' && path.find("..") == std::string::npos &&
         path.find('\\') == std::string::npos;
}

}  // namespace

Result<ZipSummary> WriteReportZip(Connection& connection, std::chrono::milliseconds timeout, const std::string& robot,
                                  std::int64_t revision, const std::filesystem::path& file) {
  RIGCAL_ASSIGN(
      const Document list,
      connection.AskDocument("report_files", JsonObject({{"robot", robot}, {"revision", revision}}), timeout));
  RIGCAL_ASSIGN(Zip zip, OpenZip(file));
  ZipSummary summary;
  for (const Document& row : list["files"].Items()) {
    const std::string path = row["path"].Text();
    const std::int64_t bytes = row["bytes"].Integer().value_or(0);
    summary.bytes += bytes;
    if (!IsPlainPath(path) || bytes < 0 || bytes > kFileBytesMax || summary.bytes > kReportBytesMax)
      return Fail(ErrorCode::kUnsupported, "the report is too large for a zip, or has a file of an odd name",
                  "Copy its folder from the server's data folder.");
    RIGCAL_ASSIGN(const std::string contents, Download(connection, timeout, robot, revision, path, bytes));
    RIGCAL_TRY(Add(zip.get(), robot + "-" + std::to_string(revision) + "/" + path, contents, file));
    ++summary.files;
  }
  if (zip_close(zip.get()) != 0) return Refused(file, zip_strerror(zip.get()));
  (void)zip.release();
  return summary;
}

}  // namespace rigcal::client
