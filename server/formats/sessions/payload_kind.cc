#include "server/formats/sessions/payload_kind.h"

#include <array>
#include <fstream>

#include "server/base/text.h"
#include "server/formats/sessions/payload_path.h"

namespace rigcal::formats {
namespace {

using std::string_view_literals::operator""sv;

struct Mark {
  std::string_view begin, kind;
};
// A PCD may leave its comment away: its header then begins with one of its first two keys.
constexpr std::array<Mark, 7> kMarks = {{{"\x89PNG\r\n\x1a\n"sv, "PNG picture"},
                                         {"\xff\xd8\xff"sv, "JPEG picture"},
                                         {"# .PCD"sv, "PCD cloud"},
                                         {"VERSION "sv, "PCD cloud"},
                                         {"FIELDS "sv, "PCD cloud"},
                                         {"ply\n"sv, "PLY cloud"},
                                         {"ply\r\n"sv, "PLY cloud"}}};
constexpr std::size_t kMarkBytesMax = 8;

std::string KindOf(std::string_view head) {
  for (const Mark& mark : kMarks)
    if (head.substr(0, mark.begin.size()) == mark.begin) return std::string(mark.kind);
  return {};
}

std::string ExpectedOf(std::string_view suffix) {
  if (suffix == "png") return "PNG picture";
  if (suffix == "pcd") return "PCD cloud";
  return suffix == "ply" ? "PLY cloud" : "JPEG picture";
}

}  // namespace

Status CheckPayloadKind(const std::filesystem::path& file, const std::string& path) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return Fail(ErrorCode::kInvalidInput, "file " + Quoted(path) + ": it cannot be opened", "Check its permissions.");
  if (SuffixOf(path) == "bin" || SuffixOf(path) == "csv") return {};
  std::array<char, kMarkBytesMax> head{};
  stream.read(head.data(), head.size());
  const std::string kind = KindOf({head.data(), static_cast<std::size_t>(stream.gcount())});
  const std::string expected = ExpectedOf(SuffixOf(path));
  if (kind == expected) return {};
  return Fail(
      ErrorCode::kInvalidInput,
      "file " + Quoted(path) + ": it is " + (kind.empty() ? "not a " + expected : "a " + kind + ", not a " + expected),
      kind.empty() ? "Record the capture again, or remove the file." : "Give it the suffix of what it is.");
}

}  // namespace rigcal::formats
