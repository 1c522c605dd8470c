// A session folder in the hands of one process: two that write into it, or remove it, would mix or lose captures.
#pragma once

#include <filesystem>

#include "server/base/files/file_descriptor.h"
#include "server/base/result.h"

namespace rigcal::importing {

// True: it was not there. Its name is on the disk when this returns, where the folder above may be opened.
[[nodiscard]] Result<bool> MakeFolder(const std::filesystem::path& folder);

class HeldFolder {
 public:
  // Makes the folder where it is missing. kConflict: another process holds it. A file system without locks holds
  // nothing.
  [[nodiscard]] static Result<HeldFolder> Take(const std::filesystem::path& folder);
  // Gives it back. Where it was made by Take and is still empty, it goes.
  ~HeldFolder();
  HeldFolder(HeldFolder&& other) noexcept = default;
  HeldFolder& operator=(HeldFolder&&) = delete;

 private:
  HeldFolder(std::filesystem::path made, FileDescriptor lock) : made_(std::move(made)), lock_(std::move(lock)) {}
  std::filesystem::path made_;  // empty: it was there
  FileDescriptor lock_;
};

}  // namespace rigcal::importing
