#include "server/pipeline/edges/decoding.h"

#include <algorithm>
#include <fstream>
#include <span>
#include <thread>

#include "server/base/limits_in_force.h"
#include "server/base/text.h"
#include "server/detect/pictures/image_header.h"
#include "server/formats/clouds/cloud.h"
#include "server/formats/sessions/payload_path.h"
#include "storage/files/blobs.h"

namespace rigcal::pipeline {
namespace {

// The most that was measured on black, noisy, chequered and smooth pictures, as PNG of 8 and 16 bit and as progressive
// JPEG, and some more: 7.2 where corners are sought, 26.9 where markers are (of noise), 45 where circles are (of
// chequers of 2 px), 12.2 in colour.
constexpr std::int64_t kCornersPixelBytes = 12, kMarkersPixelBytes = 36, kCirclesPixelBytes = 54,
                       kColouredPixelBytes = 18;
// A point: as decoded; while a plate is searched (44 measured); in maps of three levels (31); in colour and in files.
constexpr std::int64_t kPointBytes = 12, kValueBytes = 16, kSearchedPointBytes = 90, kRegisteredPointBytes = 80;
constexpr std::int64_t kColouredPointBytes = 200, kSeenPointBytes = 24;
// Of an encoded byte, while the file is read.
constexpr std::int64_t kReadBytes = 2;
// A header that a JPEG's metadata puts further back is taken for the largest picture.
constexpr std::size_t kFirstBytes = limits::kCloudHeaderBytesMax, kHeaderBytesMax = 16u << 20;

std::string StartOf(const storage::Blobs& blobs, const Payload& payload, std::size_t bytes_max) {
  std::string start(std::min(bytes_max, static_cast<std::size_t>(payload.size_bytes)), '\0');
  static_cast<void>(storage::FetchBlob(blobs, payload.digest));  // who reads all of it is told why it is not there
  std::ifstream file(storage::BlobPath(blobs.folder(), payload.digest), std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return start;
}

std::optional<detect::ImageSize> SizeOf(const storage::Blobs& blobs, const Payload& picture) {
  for (const std::size_t bytes_max : {kFirstBytes, kHeaderBytesMax}) {
    const std::string start = StartOf(blobs, picture, bytes_max);
    if (const auto size = detect::ReadImageSize(std::as_bytes(std::span(start)))) return *size;
    if (start.size() < bytes_max) return detect::ImageSize{};  // all of it: the decoder refuses it too
  }
  return std::nullopt;
}

std::int64_t PixelsOf(const std::optional<detect::ImageSize>& size) {
  return size ? size->width_px * size->height_px : limits::InForce().image_pixels;
}

formats::CloudSize CloudSizeOf(const storage::Blobs& blobs, const Payload& cloud) {
  const std::string start = StartOf(blobs, cloud, limits::kCloudHeaderBytesMax);
  return formats::ClaimedSize(std::as_bytes(std::span(start)), formats::SuffixOf(cloud.path),
                              static_cast<std::size_t>(cloud.size_bytes));
}

std::int64_t BytesToRead(const Payload& cloud, const formats::CloudSize& size) {
  return kReadBytes * cloud.size_bytes + static_cast<std::int64_t>(size.points) * kPointBytes +
         static_cast<std::int64_t>(size.values) * kValueBytes;
}

std::string PointsText(std::size_t points) { return std::to_string(points) + " points"; }

std::string InMiB(std::int64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB"; }

Error TooLargeError(const Needed& needed) {
  return {ErrorCode::kInvalidInput,
          needed.of + " would take " + InMiB(needed.bytes) + " of memory, and this server has " +
              InMiB(limits::InForce().decoded_bytes) + " for that",
          "Push it smaller, or give the server more memory (limit decoded_bytes)."};
}

}  // namespace

Needed ToSearchPicture(const storage::Blobs& blobs, const Payload& picture, const Target& target) {
  const auto size = SizeOf(blobs, picture);
  const std::string text = size ? std::to_string(size->width_px) + " x " + std::to_string(size->height_px) + " pixels"
                                : "a size that its first 16 MiB do not tell";
  const std::int64_t pixel_bytes = target.kind == TargetKind::kCheckerboard ? kCornersPixelBytes
                                   : IsCircleGrid(target.kind)              ? kCirclesPixelBytes
                                                                            : kMarkersPixelBytes;
  return {kReadBytes * picture.size_bytes + pixel_bytes * PixelsOf(size),
          "file " + Quoted(picture.path) + " of " + text};
}

Needed ToSearchCloud(const storage::Blobs& blobs, const Payload& cloud, const Target&) {
  const formats::CloudSize size = CloudSizeOf(blobs, cloud);
  return {BytesToRead(cloud, size) + static_cast<std::int64_t>(size.points) * kSearchedPointBytes,
          "file " + Quoted(cloud.path) + " of " + PointsText(size.points)};
}

Needed ToRegister(const storage::Blobs& blobs, const std::vector<const Payload*>& clouds) {
  std::int64_t held = 0, read = 0;
  std::size_t points = 0;
  for (const Payload* cloud : clouds) {
    const formats::CloudSize size = CloudSizeOf(blobs, *cloud);
    held += static_cast<std::int64_t>(size.points) * (kPointBytes + kRegisteredPointBytes);
    read = std::max(read, BytesToRead(*cloud, size));
    points += size.points;
  }
  const auto at_once = std::min<std::size_t>(clouds.size(), std::max(1u, std::thread::hardware_concurrency()));
  return {held + static_cast<std::int64_t>(at_once) * read,
          std::to_string(clouds.size()) + " clouds of " + PointsText(points)};
}

Needed ToColour(const storage::Blobs& blobs, const Payload& cloud, const std::vector<const Payload*>& pictures) {
  const formats::CloudSize size = CloudSizeOf(blobs, cloud);
  const auto shown = static_cast<std::int64_t>(std::min(size.points, limits::kColouredPointsMax));
  std::int64_t largest = 0;
  for (const Payload* picture : pictures)
    largest =
        std::max(largest, kReadBytes * picture->size_bytes + kColouredPixelBytes * PixelsOf(SizeOf(blobs, *picture)));
  const std::int64_t seen = kSeenPointBytes * static_cast<std::int64_t>(pictures.size());
  return {BytesToRead(cloud, size) + shown * (kColouredPointBytes + seen) + largest,
          "file " + Quoted(cloud.path) + " of " + PointsText(size.points) + " and " + std::to_string(pictures.size()) +
              " pictures"};
}

std::optional<Error> TooLarge(const Needed& needed) {
  if (needed.bytes <= limits::InForce().decoded_bytes) return std::nullopt;
  return TooLargeError(needed);
}

Result<MemoryBudget::Share> TakeMemory(const Needed& needed) {
  auto share = DecodingBudget().Take(needed.bytes);
  if (!share) return Fail(TooLargeError(needed));
  return std::move(*share);
}

}  // namespace rigcal::pipeline
