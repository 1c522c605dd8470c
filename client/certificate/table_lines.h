// A table of a certificate as lines of characters of one width.
#pragma once

#include <string>
#include <vector>

#include "server/model/certificate.h"

namespace rigcal::client {

struct TableLines {
  std::vector<std::string> title;              // of the columns: to be repeated on each page
  std::vector<std::vector<std::string>> rows;  // each of one line or more, which belong together
};
// Columns are as wide as the widest cell that takes one alone, names at most kNameColumns; what is longer goes on in a
// line below. Figures are right-aligned. Nothing is cut off. Control characters become spaces.
[[nodiscard]] TableLines LinesOf(const CertificateTable& table);
inline constexpr std::size_t kNameColumns = 24;

// Text in lines of at most `columns` characters, at blanks where there are any; at least one line.
[[nodiscard]] std::vector<std::string> Wrapped(const std::string& text, std::size_t columns);

}  // namespace rigcal::client
