#include "client/certificate/table_lines.h"

#include <algorithm>
#include <sstream>

#include "client/text/table.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kGap = 1, kWordsColumns = 14;  // between columns; of a column of words

// The first `count` characters; what follows stays in `word`.
std::string TakeCharacters(std::string& word, std::size_t count) {
  std::size_t end = 0;
  for (std::size_t taken = 0; end < word.size(); ++end)
    if ((static_cast<unsigned char>(word[end]) & 0xC0) != 0x80 && taken++ == count) break;
  std::string first = word.substr(0, end);
  word.erase(0, end);
  return first;
}

std::size_t LongestWord(const std::string& text) {
  std::istringstream words(text);
  std::size_t longest = 0;
  for (std::string word; words >> word;) longest = std::max(longest, WidthOf(word));
  return longest;
}

std::size_t LimitOf(const CertificateTable& table, std::size_t column) {
  if (column == 0) return kNameColumns;
  return table.columns[column].is_number ? std::string::npos : kWordsColumns;
}

std::vector<std::size_t> WidthsOf(const CertificateTable& table) {
  std::vector<std::size_t> widths;
  for (const CertificateTable::Column& column : table.columns) widths.push_back(LongestWord(column.title));
  for (const auto& row : table.rows) {
    std::size_t column = 0;
    for (const CertificateCell& cell : row) {
      if (cell.span == 1)
        widths[column] = std::max(widths[column], std::min(WidthOf(Plain(cell.text)), LimitOf(table, column)));
      column += static_cast<std::size_t>(cell.span);
    }
  }
  return widths;
}

std::string Padded(const std::string& text, std::size_t width, bool right) {
  const std::size_t taken = WidthOf(text);
  const std::string blanks(width > taken ? width - taken : 0, ' ');
  return right ? blanks + text : text + blanks;
}

std::size_t WidthOfSpan(const std::vector<std::size_t>& widths, std::size_t column, int span) {
  std::size_t width = kGap * static_cast<std::size_t>(span - 1);
  for (std::size_t i = 0; i < static_cast<std::size_t>(span); ++i) width += widths[column + i];
  return width;
}

std::vector<std::string> RowLines(const CertificateTable& table, const std::vector<CertificateCell>& row,
                                  const std::vector<std::size_t>& widths) {
  std::vector<std::string> lines;
  std::size_t column = 0, begin = 0;
  for (const CertificateCell& cell : row) {
    const std::size_t width = WidthOfSpan(widths, column, cell.span);
    const std::vector<std::string> parts = Wrapped(cell.text, width);
    lines.resize(std::max(lines.size(), parts.size()));
    for (std::size_t i = 0; i < parts.size(); ++i)
      lines[i] =
          Padded(lines[i], begin, false) + Padded(parts[i], width, cell.span == 1 && table.columns[column].is_number);
    begin += width + kGap;
    column += static_cast<std::size_t>(cell.span);
  }
  for (std::string& line : lines) line.erase(line.find_last_not_of(' ') + 1);
  return lines;
}

}  // namespace

std::vector<std::string> Wrapped(const std::string& text, std::size_t columns) {
  std::istringstream words(Plain(text));
  std::vector<std::string> lines;
  for (std::string word; words >> word;) {
    if (!lines.empty() && WidthOf(lines.back()) + 1 + WidthOf(word) <= columns) {
      lines.back() += " " + word;
      continue;
    }
    while (WidthOf(word) > columns) lines.push_back(TakeCharacters(word, std::max<std::size_t>(columns, 1)));
    if (!word.empty()) lines.push_back(word);
  }
  if (lines.empty()) lines.emplace_back();
  return lines;
}

TableLines LinesOf(const CertificateTable& table) {
  const std::vector<std::size_t> widths = WidthsOf(table);
  std::vector<CertificateCell> titles;
  for (const CertificateTable::Column& column : table.columns) titles.push_back({column.title});
  TableLines lines;
  lines.title = RowLines(table, titles, widths);
  for (const auto& row : table.rows) lines.rows.push_back(RowLines(table, row, widths));
  return lines;
}

}  // namespace rigcal::client
