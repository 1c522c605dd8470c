#include "server/http/pages/open_notice.h"

#include "server/http/pages/html_text.h"

namespace rigcal::http {
namespace {

constexpr const char* kNotice =
    "<p class=\"meta open-network\" role=\"note\">Anyone on this network can read these pages: there is no login.</p>";

// Behind the tag's '>'; npos if there is no such tag.
std::size_t EndOfTag(const std::string& html, std::string_view tag) {
  const std::size_t begin = html.find(tag);
  const std::size_t end = begin == std::string::npos ? begin : html.find('>', begin);
  return end == std::string::npos ? end : end + 1;
}

}  // namespace

bool IsPage(std::string_view content_type) { return content_type.rfind("text/html", 0) == 0; }

std::string WithNotice(std::string html, const std::string& notice) {
  std::size_t place = EndOfTag(html, "<main");
  if (place == std::string::npos) place = EndOfTag(html, "<body");
  if (place != std::string::npos) html.insert(place, notice);
  return html;
}

std::string NoteOf(const std::string& sentence) {
  return "<p class=\"meta\" role=\"note\">" + Escaped(sentence) + "</p>";
}

std::string WithOpenNotice(std::string html) { return WithNotice(std::move(html), kNotice); }

}  // namespace rigcal::http
