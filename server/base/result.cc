#include "server/base/result.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace rigcal {
namespace {

struct CodeName {
  ErrorCode code;
  std::string_view name;
};
constexpr std::array<CodeName, 8> kCodeNames = {{
    {ErrorCode::kInvalidInput, "invalid_input"},
    {ErrorCode::kNotFound, "not_found"},
    {ErrorCode::kConflict, "conflict"},
    {ErrorCode::kBusy, "busy"},
    {ErrorCode::kUnreachable, "unreachable"},
    {ErrorCode::kUnsupported, "unsupported"},
    {ErrorCode::kStorage, "storage"},
    {ErrorCode::kInternal, "internal"},
}};

// One line that ends like a sentence.
std::string AsSentence(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  if (!text.empty() && std::string_view(".!?").find(text.back()) == std::string_view::npos) text += '.';
  return text;
}

}  // namespace

std::string Sentence(const Error& error) {
  const std::string what = AsSentence(error.what);
  const std::string cure = AsSentence(error.cure);
  return what + (what.empty() || cure.empty() ? "" : " ") + cure;
}

std::string NameOf(ErrorCode code) {
  for (const CodeName& entry : kCodeNames)
    if (entry.code == code) return std::string(entry.name);
  return "internal";
}

ErrorCode ErrorCodeOf(const std::string& name) {
  for (const CodeName& entry : kCodeNames)
    if (entry.name == name) return entry.code;
  return ErrorCode::kInternal;
}

}  // namespace rigcal
