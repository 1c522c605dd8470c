#include "server/http/percent_decoding.h"

#include <civetweb.h>

namespace rigcal::http {
namespace {

bool IsHex(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

}  // namespace

std::optional<std::string> PercentDecoded(std::string_view raw, Plus plus) {
  for (std::size_t i = raw.find('%'); i != std::string_view::npos; i = raw.find('%', i + 1))
    if (i + 2 >= raw.size() || !IsHex(raw[i + 1]) || !IsHex(raw[i + 2])) return std::nullopt;
  std::string text(raw.size() + 1, '\0');
  const int size = mg_url_decode(raw.data(), static_cast<int>(raw.size()), text.data(), static_cast<int>(text.size()),
                                 plus == Plus::kIsSpace ? 1 : 0);
  if (size < 0) return std::nullopt;
  text.resize(static_cast<std::size_t>(size));
  return text;
}

}  // namespace rigcal::http
