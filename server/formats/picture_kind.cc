#include "server/formats/picture_kind.h"

#include <array>
#include <fstream>

#include "server/base/text.h"
#include "server/formats/payload_path.h"

namespace rigcal::formats {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kPngMagic = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpegMagic = "\xff\xd8\xff"sv;

std::string KindOf(std::string_view head) {
  if (head.substr(0, kPngMagic.size()) == kPngMagic) return "PNG";
  if (head.substr(0, kJpegMagic.size()) == kJpegMagic) return "JPEG";
  return {};
}

}  // namespace

Status CheckPicture(const std::filesystem::path& file, const std::string& path) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return Fail(ErrorCode::kInvalidInput, "file " + Quoted(path) + ": it cannot be opened", "Check its permissions.");
  std::array<char, kPngMagic.size()> head{};
  stream.read(head.data(), head.size());
  const std::string kind = KindOf({head.data(), static_cast<std::size_t>(stream.gcount())});
  const std::string expected = SuffixOf(path) == "png" ? "PNG" : "JPEG";
  if (kind == expected) return {};
  return Fail(ErrorCode::kInvalidInput,
              "file " + Quoted(path) + ": it is " +
                  (kind.empty() ? "not a " + expected : "a " + kind + ", not a " + expected) + " picture",
              kind.empty() ? "Record the capture again, or remove the file." : "Give it the suffix of what it is.");
}

}  // namespace rigcal::formats
