#include "server/formats/clouds/bin_layout.h"
#include "server/formats/clouds/cloud_decoders.h"
#include "server/formats/clouds/cloud_table.h"

namespace rigcal::formats {

Result<Cloud> ReadBin(std::string_view bytes, const std::optional<CloudLayout>& layout, const std::string& name) {
  RIGCAL_TRY(CheckBinLayout(bytes, layout, name));
  const CloudLayout points = layout.value_or(KittiLayout());
  const Scalar type = points.type == PointType::kFloat64 ? Scalar::kFloat64 : Scalar::kFloat32;
  CloudTable table{name, 0, 0, points.fields.size() * SizeOf(type), {}};
  for (const std::string& field : points.fields)
    table.columns.push_back({field, type, table.columns.size() * SizeOf(type), table.point_bytes, 0});
  table.points = bytes.size() / table.point_bytes;
  RIGCAL_TRY(CheckTable(table));
  return CloudOfBinary(table, std::as_bytes(std::span(bytes)), ByteOrder::kLittle);
}

}  // namespace rigcal::formats
