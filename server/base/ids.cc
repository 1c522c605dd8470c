#include "server/base/ids.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/base/text.h"

namespace rigcal {
namespace {

constexpr std::size_t kDigestDigits = 64;

bool IsNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-';
}
bool IsLowerHexDigit(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

std::string Title(std::string_view kind, std::string_view text) { return std::string(kind) + " " + Quoted(text); }

}  // namespace

Status CheckName(std::string_view kind, std::string_view text) {
  const bool good = !text.empty() && text.size() <= limits::kNameMax && text.front() != '.' && text.front() != '-' &&
                    std::all_of(text.begin(), text.end(), IsNameCharacter);
  if (good) return {};
  return Fail(ErrorCode::kInvalidInput, Title(kind, text) + " is not a valid name",
              "Use 1 to " + std::to_string(limits::kNameMax) +
                  " letters, digits, '_', '.' or '-', and do not begin with '.' or '-'.");
}

Status CheckDigest(std::string_view kind, std::string_view text) {
  if (text.size() == kDigestDigits && std::all_of(text.begin(), text.end(), IsLowerHexDigit)) return {};
  return Fail(ErrorCode::kInvalidInput, Title(kind, text) + " is not a sha256 digest",
              "Give all 64 lower-case hexadecimal digits.");
}

}  // namespace rigcal
