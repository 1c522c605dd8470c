#include "server/formats/sessions/folder_listing.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/base/text.h"

namespace rigcal::formats {
namespace {

namespace fs = std::filesystem;

bool IsInside(const fs::path& target, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), target.begin(), target.end()).first == root.end();
}

Status CheckLink(const fs::directory_entry& entry, const fs::path& root, const std::string& title) {
  std::error_code missing;
  const fs::path target = fs::canonical(entry.path(), missing);
  if (!missing && IsInside(target, fs::canonical(root))) return {};
  return Fail(ErrorCode::kInvalidInput,
              title + (missing ? ": the symbolic link leads nowhere" : ": the symbolic link leads out of the session"),
              "Put the file itself in its place.");
}

ListedEntry EntryOf(const fs::directory_entry& entry) {
  const fs::file_status status = entry.status();
  if (fs::is_directory(status)) return {entry.path().filename(), ListedEntry::Kind::kFolder, 0};
  if (!fs::is_regular_file(status)) return {entry.path().filename(), ListedEntry::Kind::kOther, 0};
  return {entry.path().filename(), ListedEntry::Kind::kFile, static_cast<std::int64_t>(entry.file_size())};
}

Result<std::vector<ListedEntry>> List(const fs::path& folder, const fs::path& root) {
  std::vector<ListedEntry> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().native().front() == '.') continue;
    const std::string title = "file " + Quoted(entry.path().lexically_relative(root).string());
    if (entry.is_symlink()) RIGCAL_TRY(CheckLink(entry, root, title));
    if (entries.size() >= limits::kPayloadsPerSessionMax)
      return Fail(ErrorCode::kInvalidInput,
                  "folder " + Quoted(folder.string()) + ": more than " +
                      std::to_string(limits::kPayloadsPerSessionMax) + " files",
                  "Split it into several sessions.");
    entries.push_back(EntryOf(entry));
  }
  std::sort(entries.begin(), entries.end(), [](const ListedEntry& a, const ListedEntry& b) { return a.name < b.name; });
  return entries;
}

}  // namespace

Result<std::vector<ListedEntry>> ListFolder(const fs::path& folder, const fs::path& root) {
  try {
    if (!fs::is_directory(folder))
      return Fail(ErrorCode::kNotFound,
                  "session folder " + Quoted(folder.string()) +
                      (fs::exists(folder) ? ": it is no folder" : ": there is no such folder"),
                  "Give the folder that holds session.yaml.");
    return List(folder, root);
  } catch (const fs::filesystem_error& problem) {
    return Fail(ErrorCode::kInvalidInput,
                "folder " + Quoted(folder.string()) + " cannot be read: " + problem.code().message(),
                "Check the folder and its permissions.");
  }
}

}  // namespace rigcal::formats
