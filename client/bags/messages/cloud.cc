#include "client/bags/messages/cloud.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>

#include "client/bags/limits.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr std::size_t kFieldCountMax = 512;

// A bag's own definition may make signed or longer numbers of what are 32 bits; of these no sum overflows.
bool Are32Bits(std::initializer_list<std::int64_t> sizes) {
  return std::all_of(sizes.begin(), sizes.end(),
                     [](std::int64_t size) { return size >= 0 && size <= std::numeric_limits<std::uint32_t>::max(); });
}

std::optional<Primitive> PrimitiveOf(std::int64_t datatype) {
  constexpr Primitive kTypes[] = {Primitive::kInt8,  Primitive::kUint8,  Primitive::kInt16,   Primitive::kUint16,
                                  Primitive::kInt32, Primitive::kUint32, Primitive::kFloat32, Primitive::kFloat64};
  if (datatype < 1 || datatype > 8) return std::nullopt;
  return kTypes[datatype - 1];
}

Status ReadFields(const Value& list, PointCloud& cloud) {
  if (list.items().size() > kFieldCountMax)
    return RefuseMessage("its points have " + std::to_string(list.items().size()) + " fields");
  for (const Value& item : list.items()) {
    const auto type = PrimitiveOf(item["datatype"].Integer());
    PointField field;
    field.name = item["name"].Text();
    if (!Are32Bits({item["offset"].Integer(), item["count"].Integer()}))
      return RefuseMessage("its field " + Quoted(field.name) + " has an offset or a count beyond 32 bits");
    field.offset_bytes = static_cast<std::size_t>(item["offset"].Integer());
    // Drivers of the first years left it 0 and meant 1.
    field.count = static_cast<std::size_t>(std::max<std::int64_t>(1, item["count"].Integer()));
    if (!type)
      return RefuseMessage("its field " + Quoted(field.name) + " has the type " +
                           std::to_string(item["datatype"].Integer()) + ", which there is not");
    field.type = *type;
    if (field.offset_bytes + field.count * SizeOf(field.type) > cloud.point_bytes)
      return RefuseMessage("its field " + Quoted(field.name) + " lies beyond the " + std::to_string(cloud.point_bytes) +
                           " bytes of a point");
    cloud.fields.push_back(std::move(field));
  }
  std::stable_sort(cloud.fields.begin(), cloud.fields.end(),
                   [](const PointField& a, const PointField& b) { return a.offset_bytes < b.offset_bytes; });
  for (const char* const name : {"x", "y", "z"}) {
    const auto found = std::find_if(cloud.fields.begin(), cloud.fields.end(),
                                    [&](const PointField& field) { return field.name == name; });
    if (found == cloud.fields.end()) return RefuseMessage(std::string("its points have no ") + name);
  }
  return {};
}

}  // namespace

Result<PointCloud> ReadPointCloud(const Value& message) {
  const auto header = HeaderOf(message["header"]);
  if (!header) return RefuseMessage("the cloud has no header");
  PointCloud cloud;
  cloud.header = *header;
  const std::int64_t width = message["width"].Integer(), height = message["height"].Integer();
  if (width < 1 || height < 1 || width > limits::kCloudPointsMax / height)
    return RefuseMessage("the cloud has " + std::to_string(width) + " x " + std::to_string(height) +
                         " points, not 1 to " + std::to_string(limits::kCloudPointsMax));
  if (!Are32Bits({message["point_step"].Integer(), message["row_step"].Integer()}))
    return RefuseMessage("the cloud has points or rows of a size beyond 32 bits");
  cloud.width = static_cast<std::size_t>(width);
  cloud.height = static_cast<std::size_t>(height);
  cloud.point_bytes = static_cast<std::size_t>(message["point_step"].Integer());
  cloud.row_bytes = static_cast<std::size_t>(message["row_step"].Integer());
  cloud.big_endian = message["is_bigendian"].Integer() != 0;
  cloud.data = message["data"].bytes();
  if (const Status read = ReadFields(message["fields"], cloud); !read) return Fail(read.error());
  // Of a cloud of one row some drivers leave row_step 0.
  if (cloud.height == 1) cloud.row_bytes = cloud.width * cloud.point_bytes;
  if (cloud.row_bytes < cloud.width * cloud.point_bytes || cloud.data.size() / cloud.height < cloud.row_bytes)
    return RefuseMessage("the cloud of " + std::to_string(width * height) + " points of " +
                         std::to_string(cloud.point_bytes) + " bytes has " + std::to_string(cloud.data.size()) +
                         " bytes in rows of " + std::to_string(cloud.row_bytes));
  return cloud;
}

Result<LaserScan> ReadLaserScan(const Value& message) {
  const auto header = HeaderOf(message["header"]);
  const Value &ranges = message["ranges"], &intensities = message["intensities"];
  if (!header || ranges.count() == 0 || ranges.count() > static_cast<std::size_t>(limits::kCloudPointsMax))
    return RefuseMessage("the scan has no header, or no ranges");
  LaserScan scan;
  scan.header = *header;
  scan.angle_min_rad = message["angle_min"].Real();
  scan.angle_increment_rad = message["angle_increment"].Real();
  scan.time_increment_s = message["time_increment"].Real();
  scan.range_min_m = message["range_min"].Real();
  scan.range_max_m = message["range_max"].Real();
  if (!std::isfinite(scan.angle_min_rad + scan.angle_increment_rad + scan.range_min_m))
    return RefuseMessage("the scan has angles that are not finite");
  const bool has_intensities = intensities.count() == ranges.count();
  for (std::size_t i = 0; i < ranges.count(); ++i) {
    scan.ranges_m.push_back(static_cast<float>(ranges.RealAt(i)));
    if (has_intensities) scan.intensities.push_back(static_cast<float>(intensities.RealAt(i)));
  }
  return scan;
}

}  // namespace rigcal::bags
