#include "client/ask/report_zip.h"

#include "client/ask/zip_file.h"
#include "server/base/digests/base64.h"

namespace rigcal::client {
namespace {

constexpr std::int64_t kReportBytesMax = 4LL << 30;
constexpr std::int64_t kFileBytesMax = 1LL << 30;

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
  RIGCAL_ASSIGN(ZipFile zip, ZipFile::Open(file));
  ZipSummary summary;
  for (const Document& row : list["files"].Items()) {
    const std::string path = row["path"].Text();
    const std::int64_t bytes = row["bytes"].Integer().value_or(0);
    summary.bytes += bytes;
    if (!IsPlainPath(path) || bytes < 0 || bytes > kFileBytesMax || summary.bytes > kReportBytesMax)
      return Fail(ErrorCode::kUnsupported, "the report is too large for a zip, or has a file of an odd name",
                  "Copy its folder from the server's data folder.");
    RIGCAL_ASSIGN(const std::string contents, Download(connection, timeout, robot, revision, path, bytes));
    RIGCAL_TRY(zip.Add(robot + "-" + std::to_string(revision) + "/" + path, contents));
    ++summary.files;
  }
  RIGCAL_TRY(zip.Close());
  return summary;
}

}  // namespace rigcal::client
