// A folder for a bag that a test writes; gone afterwards. And a disk that is full.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "tests/unit/temp_folder.h"

namespace rigcal::bags {

class BagPlace {
 public:
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "bag.mcap"; }

 private:
  TempFolder folder_;
};

// While it lives, the system's limit on the size of a file stands for a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t room_bytes) : signal_before_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{room_bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_before_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*signal_before_)(int);
  rlimit before_{};
};

}  // namespace rigcal::bags
