#include "server/formats/cloud_decoders.h"
#include "server/formats/cloud_table.h"

namespace rigcal::formats {

Result<Cloud> ReadKitti(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kFloatBytes = 4;
  CloudTable table{name, 0, 0, 0, {}};
  for (const char* field : {"x", "y", "z", "intensity"}) {
    table.columns.push_back({field, Scalar::kFloat32, table.point_bytes, 4 * kFloatBytes, 0});
    table.point_bytes += kFloatBytes;
  }
  if (bytes.size() % table.point_bytes != 0)
    return RefuseCloud(name, "has " + std::to_string(bytes.size()) + " bytes, which is no multiple of 16",
                       "A .bin holds 4 floats per point (x y z intensity, 32 bit each): copy or save it again.");
  table.points = bytes.size() / table.point_bytes;
  RIGCAL_TRY(CheckTable(table));
  return CloudOfBinary(table, std::as_bytes(std::span(bytes)), ByteOrder::kLittle);
}

}  // namespace rigcal::formats
