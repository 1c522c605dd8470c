#include "client/ask/zip_file.h"

#include <zip.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace rigcal::client {
namespace {

tl::unexpected<Error> NotWritten(const std::filesystem::path& file, const std::string& why) {
  return Fail(ErrorCode::kStorage, file.string() + " cannot be written: " + why,
              "Check its folder and the free space.");
}

}  // namespace

void ZipFile::Discard::operator()(zip_t* zip) const { zip_discard(zip); }

Result<ZipFile> ZipFile::Open(const std::filesystem::path& file) {
  int code = 0;
  Zip zip(zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (zip) return ZipFile(file, std::move(zip));
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  return NotWritten(file, why);
}

// The zip takes the copy over.
Status ZipFile::Add(const std::string& name, const std::string& contents) {
  constexpr std::time_t kTime_s = 315'532'800;  // 1980-01-01, the format's first day
  void* copy = std::malloc(std::max<std::size_t>(contents.size(), 1));
  if (copy == nullptr) return NotWritten(file_, "there is too little memory");
  std::memcpy(copy, contents.data(), contents.size());
  zip_source_t* source = zip_source_buffer(zip_.get(), copy, contents.size(), 1);
  if (source == nullptr) {
    std::free(copy);
    return NotWritten(file_, zip_strerror(zip_.get()));
  }
  const zip_int64_t index = zip_file_add(zip_.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    return NotWritten(file_, zip_strerror(zip_.get()));
  }
  zip_file_set_mtime(zip_.get(), static_cast<zip_uint64_t>(index), kTime_s, 0);
  return {};
}

Status ZipFile::Close() {
  if (zip_close(zip_.get()) != 0) return NotWritten(file_, zip_strerror(zip_.get()));
  (void)zip_.release();
  return {};
}

}  // namespace rigcal::client
