// Text as it stands in HTML. Pure.
#pragma once

#include <string>

namespace rigcal::http {

// & < > and both quotes as entities: for text and for values of attributes in quotes.
[[nodiscard]] std::string Escaped(const std::string& text);
// Everything before <main>'s contents, and behind them: the look of the other pages. `title` is no HTML.
[[nodiscard]] std::string PageAround(const std::string& title, const std::string& main);

}  // namespace rigcal::http
