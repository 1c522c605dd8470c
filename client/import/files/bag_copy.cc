#include "client/import/files/bag_copy.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "client/bags/byte_source.h"
#include "client/bags/parts.h"
#include "server/base/digests/sha256.h"
#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::importing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPieceBytes = 1 << 20;
constexpr std::size_t kCopyBytesMax = 16 << 20;

std::string TimeText(const timespec& time) { return std::to_string(time.tv_sec) + "." + std::to_string(time.tv_nsec); }

std::string MarkOf(const fs::path& file) {
  struct stat found = {};
  if (stat(file.c_str(), &found) != 0) return file.filename().string() + " -";
  return file.filename().string() + " " + std::to_string(found.st_size) + " " + std::to_string(found.st_ino) + " " +
         TimeText(found.st_mtim) + " " + TimeText(found.st_ctim);
}

std::uint64_t SizeOf(const std::vector<fs::path>& files) {
  std::uint64_t bytes = 0;
  for (const fs::path& file : files) {
    std::error_code missing;
    const auto size = fs::file_size(file, missing);
    if (!missing) bytes += size;
  }
  return bytes;
}

}  // namespace

Result<BagCopy> MarksOf(const fs::path& bag) {
  RIGCAL_ASSIGN(const bags::Parts parts, bags::PartsOf(bag));
  BagCopy copy;
  for (const fs::path& file : parts.files) copy.marks += MarkOf(file) + "\n";
  return copy;
}

Result<std::string> DigestOf(const fs::path& bag, const std::function<void(std::int64_t, std::int64_t)>& progress) {
  RIGCAL_ASSIGN(const bags::Parts parts, bags::PartsOf(bag));
  const auto total = static_cast<std::int64_t>(SizeOf(parts.files));
  std::vector<std::byte> piece(kPieceBytes);
  Sha256 sha;
  std::int64_t done = 0;
  for (const fs::path& file : parts.files) {
    const auto source = bags::OpenSource(file);
    const std::uint64_t size = source ? (*source)->size() : 0;
    sha.Add(std::to_string(size) + "\n");
    for (std::uint64_t at = 0; at < size; at += kPieceBytes) {
      const auto read = (*source)->ReadAt(at, std::span(piece));
      sha.Add(std::span<const std::byte>(piece).first(read ? *read : 0));
      done += static_cast<std::int64_t>(std::min<std::uint64_t>(kPieceBytes, size - at));
      if (progress) progress(done, total);
    }
  }
  return sha.Finish().str();
}

Result<bool> HasBytesOf(const BagCopy& before, const fs::path& bag, BagCopy& now,
                        const std::function<void(std::int64_t, std::int64_t)>& progress) {
  if (now.marks == before.marks) {
    now.sha256 = before.sha256;
    return true;
  }
  RIGCAL_ASSIGN(now.sha256, DigestOf(bag, progress));
  return now.sha256 == before.sha256;
}

std::string BagCopyJson(const BagCopy& copy) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Integer("format", 1);
    out.Text("marks", copy.marks);
    out.Text("sha256", copy.sha256);
  });
}

Result<BagCopy> ReadBagCopy(const std::string& text) {
  const formats::JsonKind kind{"what an import kept of its bag", "Remove its folder, and import the bag again.",
                               kCopyBytesMax};
  RIGCAL_ASSIGN(auto document, formats::JsonDocument::Parse(text, kind));
  BagCopy copy{document.Root().At("marks").Text(kCopyBytesMax), document.Root().At("sha256").Text()};
  RIGCAL_TRY(document.status());
  return copy;
}

}  // namespace rigcal::importing
