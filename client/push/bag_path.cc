#include "client/push/bag_path.h"

#include <string>

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

bool IsPartOfBag(const fs::path& file) {
  if (file.filename() == "metadata.yaml") return true;
  const fs::path inner = file.extension() == ".zstd" ? file.stem() : file.filename();
  return inner.extension() == ".mcap" || inner.extension() == ".db3" || inner.extension() == ".bag";
}

}  // namespace

bool IsBagPath(const fs::path& path) {
  std::error_code failed;
  if (fs::is_regular_file(path, failed)) return path.filename() != "session.yaml";
  if (!fs::is_directory(path, failed) || fs::exists(path / "session.yaml", failed)) return false;
  for (fs::directory_iterator at(path, failed), end; !failed && at != end; at.increment(failed))
    if (IsPartOfBag(at->path())) return true;
  return false;
}

fs::path PushFolderOf(const fs::path& bag, const fs::path& work) {
  fs::path whole = fs::absolute(bag).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();  // "visit/"
  return (work.empty() ? whole.parent_path() : work) / (whole.filename().string() + ".rigcal-push");
}

}  // namespace rigcal::client
