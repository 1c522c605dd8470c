// Columns of text for people: a title line, rows, columns as wide as their widest cell.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace rigcal::client {

enum class Align { kLeft, kRight };
struct Column {
  std::string title;
  Align align = Align::kLeft;
};

class Table {
 public:
  // Without rows.
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  // Missing cells are empty; cells beyond the columns are dropped.
  void Add(std::vector<std::string> cells);
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  // Two spaces between columns, none at the end of a line. Line breaks and control characters in cells become spaces.
  void Print(std::ostream& out) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

// What a terminal may show of a text from elsewhere: control characters become spaces.
[[nodiscard]] std::string Plain(const std::string& text);
// Characters as a terminal counts them (UTF-8 code points).
[[nodiscard]] std::size_t WidthOf(const std::string& text);
// "12.345", or "-" where nothing is known.
[[nodiscard]] std::string Fixed(std::optional<double> value, int digits);
// The same in other units: value * scale.
[[nodiscard]] std::string Scaled(std::optional<double> value, double scale, int digits);
// "1.2 GB", "34 kB": powers of 1000.
[[nodiscard]] std::string ByteText(double bytes);

}  // namespace rigcal::client
