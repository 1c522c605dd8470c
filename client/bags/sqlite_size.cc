#include "client/bags/sqlite_size.h"

#include <array>
#include <fstream>

namespace rigcal::bags {
namespace {

constexpr std::size_t kHeaderBytes = 100;

std::uint64_t BigEndian(const std::array<char, kHeaderBytes>& header, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(header[at + i]);
  return value;
}

}  // namespace

std::uint64_t ClaimedSqliteBytes(const std::filesystem::path& file) {
  std::error_code none;
  if (std::filesystem::file_size(file.string() + "-wal", none) > 0 && !none) return 0;
  std::array<char, kHeaderBytes> header{};
  if (!std::ifstream(file, std::ios::binary).read(header.data(), header.size())) return 0;
  const bool is_valid = BigEndian(header, 24, 4) == BigEndian(header, 92, 4);  // the count is of the last change
  const std::uint64_t page = BigEndian(header, 16, 2);
  return is_valid ? BigEndian(header, 28, 4) * (page == 1 ? 65'536 : page) : 0;
}

}  // namespace rigcal::bags
