#include <fstream>

#include "client/bags/sqlite_bag.h"
#include "client/bags/temporary_file.h"
#include "tests/fuzz/bag_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = rigcal::bags::TemporaryFile::Make(".db3");
  rigcal::fuzz::Require(file.has_value(), "there is a place for a file");
  std::ofstream((*file)->path(), std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  rigcal::fuzz::CheckBag(rigcal::bags::OpenSqliteBag((*file)->path()));
  return 0;
}
