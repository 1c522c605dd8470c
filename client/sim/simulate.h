// Writes what a virtual robot records as a session folder (docs/session-format.md), with truth.yaml beside
// session.yaml.
#pragma once

#include <filesystem>
#include <functional>

#include "client/sim/truth.h"
#include "client/sim/views/picture.h"

namespace rigcal::sim {

struct WriteOptions {
  PictureFormat format = PictureFormat::kJpeg;
  int threads = 0;  // 0: as many as the machine has
};

struct WriteSummary {
  std::size_t pictures = 0, clouds = 0, points = 0;
  std::int64_t pixels = 0, bytes = 0;
  double pictures_s = 0.0;  // of processor time, all threads together: drawing and encoding
  int threads = 1;

  // Of one thread.
  [[nodiscard]] double MegapixelsPerSecond() const;
};

// Files done, files in all; called under a lock, from any thread.
using FilesProgress = std::function<void(std::size_t, std::size_t)>;

// The folder must be new or empty. The files' bytes do not depend on threads.
[[nodiscard]] Result<WriteSummary> WriteSession(const Experiment& experiment, const Truth& truth,
                                                const std::filesystem::path& folder, const WriteOptions& options,
                                                const FilesProgress& progress);

}  // namespace rigcal::sim
