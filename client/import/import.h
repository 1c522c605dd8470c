// A bag becomes a session folder (docs/session-format.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/import/captures.h"
#include "client/import/intake.h"
#include "client/import/still_moments.h"
#include "server/base/result.h"

namespace rigcal::importing {

struct ImportInput {
  std::filesystem::path bag, rig, out;
  std::optional<std::int64_t> tolerance_ns, every_ns;  // in place of what rig.yaml says
  bool replaces_other_import = false;  // `out` is nobody else's: what another import began there is removed
};

// What became of one sensor's messages.
struct SensorOutcome {
  std::string id, topic;
  std::int64_t messages = 0;  // of its topic
  std::int64_t written = 0;   // files, or rows of poses.csv
  std::int64_t refused = 0;   // that could not be used
  std::string first_refusal;
  SensorUse use;                     // of a camera or lidar: of those with a stamp
  std::int64_t repeated_stamps = 0;  // of a pose stream: rows whose stamp is not after the one before
  std::string camera_change = {};    // of a camera: "/left/camera_info changes at ...", where it does
};

struct ImportOutcome {
  std::size_t captures = 0;
  std::int64_t tolerance_ns = 0;
  std::int64_t kept_files = 0;  // that an import which was cut off had written
  bool was_complete = false;    // nothing was left to do, nothing was read; the rest is as it was told then
  std::vector<SensorOutcome> sensors;
  std::optional<MomentsTold> moments;  // of a stream
  bool shows_no_board = false;         // of a stream: nothing tells what stood still, and it was taken by its stamps
  std::vector<Error> damage;           // of the bag
};

// Reads the bag three times: for its digest, for the stamps, and for the files of what is a capture; a stream in
// between for its still moments, of which session.yaml tells under `conditions`. Cut off, it goes on where it was when
// it is begun again; `out` is held meanwhile (files/held_folder.h). Before the first file is written, the disk has to
// have room for all (kBusy; an estimate). The same bag, rig.yaml and options give the same bytes. `progress` may be
// empty; it is called from 0 to the end each time.
[[nodiscard]] Result<ImportOutcome> Import(const ImportInput& input, const Progress& progress);

}  // namespace rigcal::importing
