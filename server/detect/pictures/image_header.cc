#include "server/detect/pictures/image_header.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "server/base/limits_in_force.h"

namespace rigcal::detect {
namespace {

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::array<std::uint8_t, 4> kIhdr = {'I', 'H', 'D', 'R'};

// No camera has more; a damaged header easily says so.
constexpr std::int64_t kSideMax_px = 1'000'000;

using Bytes = std::span<const std::byte>;

std::uint8_t At(Bytes bytes, std::size_t offset) { return std::to_integer<std::uint8_t>(bytes[offset]); }

std::int64_t BigEndian(Bytes bytes, std::size_t offset, std::size_t count) {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value * 256 + At(bytes, offset + i);
  return value;
}

template <std::size_t N>
bool HasAt(Bytes bytes, std::size_t offset, const std::array<std::uint8_t, N>& wanted) {
  if (bytes.size() < offset + N) return false;
  for (std::size_t i = 0; i < N; ++i)
    if (At(bytes, offset + i) != wanted[i]) return false;
  return true;
}

tl::unexpected<Error> CutOff() {
  return Fail(ErrorCode::kInvalidInput, "the picture's header is cut off", "save or copy the picture again");
}

Result<ImageSize> ReadPng(Bytes bytes) {
  if (bytes.size() < 24 || !HasAt(bytes, 12, kIhdr)) return CutOff();
  return ImageSize{BigEndian(bytes, 16, 4), BigEndian(bytes, 20, 4)};
}

// SOF0..SOF15 without DHT (C4), JPG (C8) and DAC (CC), which share the range.
bool IsStartOfFrame(std::uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// Markers without a length: TEM and the restart markers.
bool IsBare(std::uint8_t marker) { return marker == 0x01 || (marker >= 0xD0 && marker <= 0xD7); }

// Of the first start-of-frame segment.
Result<std::size_t> FrameOffset(Bytes bytes) {
  std::size_t offset = 2;
  while (offset + 4 <= bytes.size() && At(bytes, offset) == 0xFF) {
    const std::uint8_t marker = At(bytes, offset + 1);
    if (marker == 0xFF) {  // fill byte
      ++offset;
    } else if (IsBare(marker)) {
      offset += 2;
    } else if (IsStartOfFrame(marker)) {
      if (bytes.size() < offset + 9) return CutOff();
      return offset;
    } else {
      offset += 2 + static_cast<std::size_t>(std::max<std::int64_t>(2, BigEndian(bytes, offset + 2, 2)));
    }
  }
  return CutOff();
}

Result<ImageSize> ReadJpeg(Bytes bytes) {
  RIGCAL_ASSIGN(const std::size_t offset, FrameOffset(bytes));
  return ImageSize{BigEndian(bytes, offset + 7, 2), BigEndian(bytes, offset + 5, 2)};
}

bool IsJpeg(Bytes bytes) { return HasAt(bytes, 0, std::array<std::uint8_t, 3>{0xFF, 0xD8, 0xFF}); }

Result<ImageSize> ReadUnchecked(Bytes bytes) {
  if (HasAt(bytes, 0, kPngSignature)) return ReadPng(bytes);
  if (IsJpeg(bytes)) return ReadJpeg(bytes);
  return Fail(ErrorCode::kInvalidInput, "the picture is neither PNG nor JPEG", "export it as PNG or JPEG");
}

std::string MegapixelsText(std::int64_t pixels) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g megapixels", static_cast<double>(pixels) * 1e-6);
  return text.data();
}

}  // namespace

Result<ImageSize> ReadImageSize(Bytes encoded) {
  RIGCAL_ASSIGN(const ImageSize size, ReadUnchecked(encoded));
  const std::string text = std::to_string(size.width_px) + " x " + std::to_string(size.height_px) + " pixels";
  if (size.width_px == 0 || size.height_px == 0)
    return Fail(ErrorCode::kInvalidInput, "the picture claims " + text, "save or copy the picture again");
  const std::int64_t pixels_max = limits::InForce().image_pixels;
  if (std::max(size.width_px, size.height_px) > kSideMax_px)
    return Fail(ErrorCode::kInvalidInput, "the picture is damaged: the size in its header is impossible",
                "save or copy the picture again");
  // Both factors are below 2^32, so the division decides without overflow.
  if (size.width_px > pixels_max / size.height_px)
    return Fail(ErrorCode::kInvalidInput,
                "the picture claims " + text + ", more than the limit of " + MegapixelsText(pixels_max),
                "use smaller pictures");
  return size;
}

bool IsCutOff(Bytes encoded) {
  if (!IsJpeg(encoded)) return false;
  const auto frame = FrameOffset(encoded);
  if (!frame) return true;
  // A preview in front of the frame has an end of its own; within compressed data the two bytes cannot occur.
  for (std::size_t offset = encoded.size() - 2; offset > *frame; --offset)
    if (At(encoded, offset) == 0xFF && At(encoded, offset + 1) == 0xD9) return false;
  return true;
}

}  // namespace rigcal::detect
