#include "server/formats/boards/square_sizes.h"

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kSizesMax = 10'000, kSizesBytesMax = 4u << 20;

}  // namespace

std::string WriteSquareSizes(const SquareSizes& sizes) {
  if (sizes.empty()) return "";
  return WriteObject([&](JsonWriter& out) {
    for (const auto& [target, size] : sizes)
      out.Object(target.str(), [&] {
        out.Number("square_m", size.square_m);
        out.Number("square_sigma_m", size.square_sigma_m);
      });
  });
}

Result<SquareSizes> ReadSquareSizes(const std::string& text) {
  SquareSizes sizes;
  if (text.empty()) return sizes;
  RIGCAL_ASSIGN(JsonDocument document,
                JsonDocument::Parse(text, {"square sizes", "This is a fault of the store: put a backup in its place.",
                                           kSizesBytesMax}));
  for (const auto& [name, field] : document.Root().Members(kSizesMax)) {
    const SquareSize size{field.At("square_m").Number(), field.At("square_sigma_m").Number()};
    if (size.square_m <= 0.0 || size.square_sigma_m < 0.0) field.Refuse("is no size of a square");
    sizes.emplace(TargetId(name), size);
  }
  RIGCAL_TRY(document.status());
  return sizes;
}

}  // namespace rigcal::formats
