#include "server/pipeline/reports/report_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "server/base/digests/base64.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::pipeline {
namespace {

namespace fs = std::filesystem;
using formats::JsonWriter;

constexpr std::size_t kFilesMax = 100'000;

fs::path FolderOf(const storage::Store& store, const RobotId& robot, int revision) {
  return store.ReportFolder() / robot.str() / std::to_string(revision);
}

struct File {
  std::string path;
  std::int64_t bytes = 0;
};

Result<std::vector<File>> FilesOf(const fs::path& folder) {
  std::vector<File> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->is_regular_file(error) && files.size() < kFilesMax)
      files.push_back(
          {at->path().lexically_relative(folder).generic_string(), static_cast<std::int64_t>(at->file_size(error))});
  if (error || files.empty())
    return Fail(ErrorCode::kNotFound, "this report is not published", "Look again in a moment.");
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.path < b.path; });
  return files;
}

// A relative path of names alone, to a file as it is: none leads out of the folder.
std::optional<std::int64_t> BytesOf(const fs::path& folder, const std::string& path) {
  const fs::path relative(path);
  std::error_code error;
  if (path.empty() || relative.is_absolute() || relative.lexically_normal() != relative || *relative.begin() == "..")
    return std::nullopt;
  if (!fs::is_regular_file(fs::symlink_status(folder / relative, error)) || error) return std::nullopt;
  const auto bytes = fs::file_size(folder / relative, error);
  return error ? std::nullopt : std::optional(static_cast<std::int64_t>(bytes));
}

}  // namespace

Result<std::string> ReportFiles(const storage::Store& store, const RobotId& robot, int revision) {
  RIGCAL_ASSIGN(const auto files, FilesOf(FolderOf(store, robot, revision)));
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("robot", robot.str());
    out.Integer("revision", revision);
    out.List("files", [&] {
      for (const File& file : files)
        out.Object([&] {
          out.Text("path", file.path);
          out.Integer("bytes", file.bytes);
        });
    });
  });
}

Result<std::string> ReportFile(const storage::Store& store, const RobotId& robot, int revision, const std::string& path,
                               std::int64_t offset) {
  const fs::path folder = FolderOf(store, robot, revision);
  const auto known = BytesOf(folder, path);
  if (!known || offset < 0 || offset > *known)
    return Fail(ErrorCode::kNotFound, "the report has no such piece of a file", "Ask for the list with report_files.");
  std::string piece(static_cast<std::size_t>(std::min(*known - offset, kReportPieceBytes)), '\0');
  std::ifstream file(folder / path, std::ios::binary);
  file.seekg(offset);
  if (!file.read(piece.data(), static_cast<std::streamsize>(piece.size())))
    return Fail(ErrorCode::kStorage, "a file of the report cannot be read", "Check the disk of the server.");
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("path", path);
    out.Integer("offset", offset);
    out.Integer("bytes", *known);
    out.Text("base64", ToBase64(piece));
  });
}

}  // namespace rigcal::pipeline
