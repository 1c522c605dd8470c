// What every page says while anybody on the network can read it, or who is logged in. Pure.
#pragma once

#include <string>
#include <string_view>

namespace rigcal::http {

[[nodiscard]] bool IsPage(std::string_view content_type);  // HTML
// `html` with `notice` (HTML) at the beginning of its <main>, or of its <body> where it has none; as it is without
// either.
[[nodiscard]] std::string WithNotice(std::string html, const std::string& notice);
[[nodiscard]] std::string WithOpenNotice(std::string html);
// A sentence as such a notice.
[[nodiscard]] std::string NoteOf(const std::string& sentence);

}  // namespace rigcal::http
