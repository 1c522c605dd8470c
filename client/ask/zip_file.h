// A new zip, file by file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/base/result.h"

struct zip;

namespace rigcal::client {

// Not there until Close: one that was not closed leaves nothing. kStorage: it cannot be written.
class ZipFile {
 public:
  [[nodiscard]] static Result<ZipFile> Open(const std::filesystem::path& file);
  // `name` within it. The contents are copied; all have one time, so that the same contents make the same zip.
  [[nodiscard]] Status Add(const std::string& name, const std::string& contents);
  [[nodiscard]] Status Close();

 private:
  struct Discard {
    void operator()(zip* zip) const;
  };
  using Zip = std::unique_ptr<zip, Discard>;
  ZipFile(std::filesystem::path file, Zip zip) : file_(std::move(file)), zip_(std::move(zip)) {}

  std::filesystem::path file_;
  Zip zip_;
};

}  // namespace rigcal::client
