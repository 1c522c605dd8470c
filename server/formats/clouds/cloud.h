// Point clouds of lidars: PCD, PLY, .bin.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/model/sensors/cloud.h"
#include "server/model/sensors/cloud_layout.h"

namespace rigcal::formats {

// `suffix`: "pcd" (0.5 to 0.7: ascii, binary, binary_compressed), "ply" (1.0: ascii, binary_little_endian,
// binary_big_endian) or "bin" (numbers of the `layout`; without one, KITTI's where CheckBinLayout lets that be
// certain). Errors call the file `name`, "<sensor>/<capture>.<suffix>".
//
// Points are in the sensor's frame, metres: x y z as they stand in the file, rounded to float; a PCD's VIEWPOINT is
// ignored. A point with a coordinate that is NaN or infinite is a beam without a return: left out and counted in
// `dropped`, and so is one with a coordinate beyond 1 km (OdditiesOf tells of them). A cloud without any other point,
// or with all in one place, is refused. Organised clouds become a list, row by row. Every other number becomes a field,
// in the file's order, as double (64-bit integers round); a PCD field of COUNT n > 1 becomes name_0 ... name_(n-1); "_"
// is padding. A field without a finite value at a kept point is named in `left_out`. PLY: the element "vertex".
// Elements before it are skipped, those after it ignored; a list in or before it is refused.
//
// What a header claims is held against the bytes that are there and against limits.h before anything is allocated.
// Throws std::bad_alloc: that is no fault of the file.
[[nodiscard]] Result<Cloud> ReadCloud(std::span<const std::byte> bytes, std::string_view suffix,
                                      const std::string& name, const std::optional<CloudLayout>& layout = {});

// What a file of `file_bytes` claims to hold, at most what limits.h admits. `start`: its first kCloudHeaderBytesMax
// bytes, or all of it. Nothing is held in a file that ReadCloud refuses by its header.
struct CloudSize {
  std::size_t points = 0, values = 0;  // values: of all points, x y z included
};
// `suffix` as of ReadCloud. Zeros of a suffix that is not known.
[[nodiscard]] CloudSize ClaimedSize(std::span<const std::byte> start, std::string_view suffix, std::size_t file_bytes);

}  // namespace rigcal::formats
