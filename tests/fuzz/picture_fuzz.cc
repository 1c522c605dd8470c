#include "server/detect/pictures/grey_image.h"
#include "server/detect/pictures/image_header.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto encoded = std::as_bytes(std::span(data, size));
  const auto claimed = detect::ReadImageSize(encoded);
  if (!fuzz::RequireGoodError(claimed)) return 0;
  fuzz::Require(claimed->width_px > 0 && claimed->height_px > 0, "a picture has pixels");
  const auto image = detect::DecodeGrey(encoded);
  if (!fuzz::RequireGoodError(image)) return 0;
  fuzz::Require(image->width_px == claimed->width_px && image->height_px == claimed->height_px,
                "the size is as claimed");
  fuzz::Require(
      image->pixels.size() == static_cast<std::size_t>(image->width_px) * static_cast<std::size_t>(image->height_px),
      "every pixel is there");
  return 0;
}
