#include "server/pipeline/report_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "server/base/base64.h"
#include "server/formats/json_writer.h"

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

// Only what the list holds: so no path leads out of the folder.
Result<std::string> ReportFile(const storage::Store& store, const RobotId& robot, int revision, const std::string& path,
                               std::int64_t offset) {
  const fs::path folder = FolderOf(store, robot, revision);
  RIGCAL_ASSIGN(const auto files, FilesOf(folder));
  const auto known = std::find_if(files.begin(), files.end(), [&](const File& file) { return file.path == path; });
  if (known == files.end() || offset < 0 || offset > known->bytes)
    return Fail(ErrorCode::kNotFound, "the report has no such piece of a file", "Ask for the list with report_files.");
  std::string piece(static_cast<std::size_t>(std::min(known->bytes - offset, kReportPieceBytes)), '\0');
  std::ifstream file(folder / path, std::ios::binary);
  file.seekg(offset);
  if (!file.read(piece.data(), static_cast<std::streamsize>(piece.size())))
    return Fail(ErrorCode::kStorage, "a file of the report cannot be read", "Check the disk of the server.");
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("path", path);
    out.Integer("offset", offset);
    out.Integer("bytes", known->bytes);
    out.Text("base64", ToBase64(piece));
  });
}

}  // namespace rigcal::pipeline
