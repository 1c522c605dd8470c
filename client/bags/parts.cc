#include "client/bags/parts.h"

#include <algorithm>
#include <cctype>

#include "client/bags/limits.h"
#include "server/base/durable_file.h"
#include "server/formats/yaml_field.h"

namespace rigcal::bags {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kMetadataCure = "Mend it with `ros2 bag reindex`, or take it away.";

// "wbag_2" before "wbag_10": runs of digits are compared as numbers.
bool ByNumber(const fs::path& a, const fs::path& b) {
  const auto key = [](const fs::path& path) {
    std::string padded, digits;
    const auto flush = [&] {
      padded += std::string(digits.empty() || digits.size() > 20 ? 0 : 20 - digits.size(), '0') + digits;
      digits.clear();
    };
    for (const char c : path.filename().string()) {
      if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
        digits += c;
        continue;
      }
      flush();
      padded += c;
    }
    flush();
    return padded;
  };
  return std::pair(key(a), a) < std::pair(key(b), b);
}

bool IsPart(const fs::path& file) {
  const fs::path inner = file.extension() == ".zstd" ? file.stem() : file.filename();
  return inner.extension() == ".mcap" || inner.extension() == ".db3" || inner.extension() == ".bag";
}

Result<std::vector<fs::path>> PartsInFolder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (IsPart(at->path()) && files.size() < limits::kPartsMax) files.push_back(at->path());
  if (failed) return Fail(ErrorCode::kStorage, folder.string() + ": cannot be read (" + failed.message() + ")", "Check its permissions.");
  if (files.empty())
    return Fail(ErrorCode::kInvalidInput, folder.string() + " holds no bag: neither .mcap nor .db3 nor .bag", "Give the path of a bag.");
  std::sort(files.begin(), files.end(), ByNumber);
  return files;
}

// Old versions wrote paths that begin with the bag's own name, so only the last part of each counts.
Status ReadMetadata(const fs::path& folder, Parts& parts) {
  RIGCAL_ASSIGN(const std::string text, ReadFile(folder / kMetadata, limits::kMetadataBytesMax));
  RIGCAL_ASSIGN(const auto tree, formats::ParseYaml(text, (folder / kMetadata).string(), kMetadataCure, limits::kMetadataBytesMax));
  const formats::YamlField info = formats::YamlField(*tree).At("rosbag2_bagfile_information");
  for (const formats::YamlField& path : info.At("relative_file_paths").Items())
    if (parts.files.size() < limits::kPartsMax) parts.files.push_back(folder / fs::path(path.Text()).filename());
  if (const auto topics = info.Find("topics_with_message_count"); topics && !tree->error)
    for (const formats::YamlField& entry : topics->Items()) {
      const formats::YamlField topic = entry.At("topic_metadata");
      parts.encodings[topic.At("name").Text()] = topic.At("serialization_format").Text();
    }
  if (tree->error) return Fail(*tree->error);
  return {};
}

}  // namespace

Result<Parts> PartsOf(const fs::path& bag) {
  Parts parts;
  std::error_code failed;
  if (!fs::is_directory(bag, failed)) {
    parts.files.push_back(bag);
    return parts;
  }
  if (!fs::exists(bag / kMetadata, failed)) {
    RIGCAL_ASSIGN(parts.files, PartsInFolder(bag));
    return parts;
  }
  const Status read = ReadMetadata(bag, parts);
  if (!read) parts.doubts.push_back(read.error());
  if (!read || parts.files.empty()) {
    RIGCAL_ASSIGN(parts.files, PartsInFolder(bag));
  }
  return parts;
}

}  // namespace rigcal::bags
