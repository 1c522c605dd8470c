#include "server/formats/clouds/cloud.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/formats/clouds/cloud_decoders.h"
#include "server/formats/clouds/cloud_oddities.h"
#include "server/formats/clouds/cloud_table.h"
#include "server/formats/clouds/pcd_header.h"

namespace rigcal::formats {
namespace {

Result<Cloud> Decode(std::string_view bytes, std::string_view suffix, const std::string& name,
                     const std::optional<CloudLayout>& layout) {
  if (bytes.empty()) return RefuseCloud(name, "is empty", "Copy or record it again.");
  if (suffix == "pcd") return ReadPcd(bytes, name);
  if (suffix == "ply") return ReadPly(bytes, name);
  if (suffix == "bin") return ReadBin(bytes, layout, name);
  return RefuseCloud(name, "clouds of the suffix " + Quoted(suffix) + " are not known",
                     "Save the cloud as .pcd, .ply or .bin.");
}

CloudSize Bounded(std::size_t points, std::size_t values_per_point) {
  points = std::min(points, limits::kCloudPointsMax);
  return {points, std::min(points * std::min(values_per_point, limits::kCloudFieldsMax), limits::kCloudValuesMax)};
}

}  // namespace

Result<Cloud> ReadCloud(std::span<const std::byte> bytes, std::string_view suffix, const std::string& name,
                        const std::optional<CloudLayout>& layout) {
  RIGCAL_ASSIGN(Cloud cloud, Decode({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, suffix, name, layout));
  RIGCAL_TRY(CheckUseful(cloud, name));
  return cloud;
}

CloudSize ClaimedSize(std::span<const std::byte> start, std::string_view suffix, std::size_t file_bytes) {
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  if (suffix == "bin") return Bounded(file_bytes / 12, 4);  // three numbers a point at the least
  if (suffix == "ply") {
    const auto size = PlySize(text);
    return size ? Bounded(size->first, size->second) : CloudSize{};
  }
  const auto header = ReadPcdHeader(text, "");
  if (suffix != "pcd" || !header) return {};
  std::size_t values = 0;
  for (const PcdField& field : header->fields) values += field.count;
  return Bounded(header->points, values);
}

}  // namespace rigcal::formats
