#include "storage/postgres/postgres_copy.h"

#include <bit>
#include <string_view>

namespace rigcal::storage {
namespace {

constexpr std::string_view kSignature("PGCOPY\n\377\r\n\0", 11);

void AddSized(std::string_view bytes, std::string& data) {
  data += BigEndianOf(bytes.size(), 4);
  data += bytes;
}

void AddCell(const StoredCell& cell, std::string& data) {
  if (const auto* whole = std::get_if<std::int64_t>(&cell))
    return AddSized(BigEndianOf(static_cast<std::uint64_t>(*whole), 8), data);
  if (const auto* real = std::get_if<double>(&cell))
    return AddSized(BigEndianOf(std::bit_cast<std::uint64_t>(*real), 8), data);
  if (const auto* text = std::get_if<std::string>(&cell)) return AddSized(*text, data);
  if (const auto* blob = std::get_if<Blob>(&cell)) return AddSized(blob->bytes, data);
  data += BigEndianOf(~std::uint64_t{0}, 4);  // a length of -1: NULL
}

}  // namespace

std::string BigEndianOf(std::uint64_t bits, int count) {
  std::string bytes;
  for (int shift = 8 * (count - 1); shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(bits >> shift & 0xff));
  return bytes;
}

// No flags, no extension; -1 in the place of a row's number of columns is the end.
std::string CopyDataOf(const std::vector<StoredRow>& rows) {
  std::string data(kSignature);
  data += BigEndianOf(0, 4) + BigEndianOf(0, 4);
  for (const StoredRow& row : rows) {
    data += BigEndianOf(row.size(), 2);
    for (const StoredCell& cell : row) AddCell(cell, data);
  }
  return data + BigEndianOf(~std::uint64_t{0}, 2);
}

}  // namespace rigcal::storage
