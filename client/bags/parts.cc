#include "client/bags/parts.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>

#include "client/bags/limits.h"
#include "server/base/files/durable_file.h"
#include "server/base/text.h"

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
  if (failed)
    return Fail(ErrorCode::kStorage, folder.string() + ": cannot be read (" + failed.message() + ")",
                "Check its permissions.");
  if (files.empty())
    return Fail(ErrorCode::kInvalidInput, folder.string() + " holds no bag: neither .mcap nor .db3 nor .bag",
                "Give the path of a bag.");
  std::sort(files.begin(), files.end(), ByNumber);
  return files;
}

// Text of a member, empty where there is none.
std::string TextOf(const YAML::Node& map, const char* key) {
  const YAML::Node member = map.IsMap() ? map[key] : YAML::Node();
  return member && member.IsScalar() ? member.Scalar() : "";
}

// Old versions wrote paths that begin with the bag's own name, so only the last part of each counts. Throws what
// yaml-cpp throws.
void ReadInfo(const YAML::Node& info, const fs::path& folder, Parts& parts) {
  for (const YAML::Node& path : info["relative_file_paths"])
    if (parts.files.size() < limits::kPartsMax && path.IsScalar() && !path.Scalar().empty())
      parts.files.push_back(folder / fs::path(path.Scalar()).filename());
  for (const YAML::Node& entry : info["topics_with_message_count"]) {
    const YAML::Node topic = entry.IsMap() ? entry["topic_metadata"] : YAML::Node();
    const std::string name = topic ? TextOf(topic, "name") : "",
                      encoding = topic ? TextOf(topic, "serialization_format") : "";
    if (!name.empty() && !encoding.empty() && parts.encodings.size() < limits::kTopicsMax)
      parts.encodings[name] = encoding;
  }
}

// Its texts of QoS have line breaks, which our own YAML does not take.
Status ReadMetadata(const fs::path& folder, Parts& parts) {
  RIGCAL_ASSIGN(const std::string text, ReadFile(folder / kMetadata, limits::kMetadataBytesMax));
  const std::string name = (folder / kMetadata).string();
  try {
    const YAML::Node info = YAML::Load(text)["rosbag2_bagfile_information"];
    if (info && info.IsMap()) ReadInfo(info, folder, parts);
  } catch (const std::exception& failure) {
    return Fail(ErrorCode::kInvalidInput, name + " cannot be read: " + Quoted(failure.what()), kMetadataCure);
  }
  if (!parts.files.empty()) return {};
  return Fail(ErrorCode::kInvalidInput, name + " names no file of the bag", kMetadataCure);
}

// A recorder that was ended before it wrote metadata.yaml anew, or a part copied from elsewhere: it is not read.
void DoubtUnlisted(const fs::path& folder, Parts& parts) {
  const auto there = PartsInFolder(folder);
  const auto plain = [](const fs::path& file) {
    return (file.extension() == ".zstd" ? file.stem() : file.filename()).string();
  };
  for (const fs::path& file : there ? *there : std::vector<fs::path>()) {
    const bool is_listed = std::any_of(parts.files.begin(), parts.files.end(),
                                       [&](const fs::path& listed) { return plain(listed) == plain(file); });
    if (!is_listed)
      parts.doubts.push_back({ErrorCode::kInvalidInput,
                              file.string() + " is a part of a bag that metadata.yaml does not list: it was not read",
                              "`ros2 bag reindex` lists it; take the file out if it is of another bag."});
  }
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
  if (read) {
    DoubtUnlisted(bag, parts);
    return parts;
  }
  RIGCAL_ASSIGN(parts.files, PartsInFolder(bag));
  parts.doubts.push_back(read.error());
  return parts;
}

}  // namespace rigcal::bags
