#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "client/import/files.h"

namespace rigcal::importing {
namespace {

char TypeLetter(bags::Primitive type) {
  if (type == bags::Primitive::kFloat32 || type == bags::Primitive::kFloat64) return 'F';
  const bool is_signed =
      type == bags::Primitive::kInt8 || type == bags::Primitive::kInt16 || type == bags::Primitive::kInt32;
  return is_signed ? 'I' : 'U';
}

// A word of a PCD's header, of each name one.
std::string WordOf(const std::string& name, std::set<std::string>& taken) {
  std::string word;
  for (const char c : name) word += std::isgraph(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (word.empty()) word = "field";
  std::string unique = word;
  for (int i = 2; !taken.insert(unique).second; ++i) unique = word + "_" + std::to_string(i);
  return unique;
}

std::string Header(const std::vector<bags::PointField>& fields, std::size_t width, std::size_t height) {
  std::string names, sizes, types, counts;
  std::set<std::string> taken;
  for (const bags::PointField& field : fields) {
    names += " " + WordOf(field.name, taken);
    sizes += " " + std::to_string(bags::SizeOf(field.type));
    types += std::string(" ") + TypeLetter(field.type);
    counts += " " + std::to_string(field.count);
  }
  return "VERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts + "\nWIDTH " +
         std::to_string(width) + "\nHEIGHT " + std::to_string(height) + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
         std::to_string(width * height) + "\nDATA binary\n";
}

void AppendField(const std::byte* point, const bags::PointField& field, bool swap, std::string& bytes) {
  const std::size_t size = bags::SizeOf(field.type), begin = bytes.size();
  bytes.append(reinterpret_cast<const char*>(point + field.offset_bytes), size * field.count);
  for (std::size_t at = begin; swap && at < bytes.size(); at += size)
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
}

std::string Number(double value) {
  char text[40];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return {text, end};
}

}  // namespace

std::string PcdOf(const bags::PointCloud& cloud) {
  std::string bytes = Header(cloud.fields, cloud.width, cloud.height);
  bytes.reserve(bytes.size() + cloud.width * cloud.height * cloud.point_bytes);
  for (std::size_t row = 0; row < cloud.height; ++row)
    for (std::size_t column = 0; column < cloud.width; ++column) {
      const std::byte* point = cloud.data.data() + row * cloud.row_bytes + column * cloud.point_bytes;
      for (const bags::PointField& field : cloud.fields) AppendField(point, field, cloud.big_endian, bytes);
    }
  return bytes;
}

std::string PcdOf(const bags::LaserScan& scan) {
  std::vector<bags::PointField> fields = {{"x"}, {"y"}, {"z"}};
  if (!scan.intensities.empty()) fields.push_back({"intensity"});
  std::string bytes = Header(fields, scan.ranges_m.size(), 1);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = scan.ranges_m[i];
    const bool returned = range_m >= scan.range_min_m && range_m <= scan.range_max_m;
    const double angle_rad = scan.angle_min_rad + static_cast<double>(i) * scan.angle_increment_rad;
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    float point[4] = {returned ? static_cast<float>(range_m * std::cos(angle_rad)) : kNone,
                      returned ? static_cast<float>(range_m * std::sin(angle_rad)) : kNone, returned ? 0.0F : kNone,
                      0.0F};
    if (!scan.intensities.empty()) point[3] = scan.intensities[i];
    char raw[sizeof point];
    std::memcpy(raw, point, sizeof point);
    bytes.append(raw, fields.size() * sizeof(float));
  }
  return bytes;
}

std::string PoseColumns(std::int64_t stamp_ns, const Se3& T) {
  std::string text = std::to_string(stamp_ns);
  for (int i = 0; i < 3; ++i) text += "," + Number(T.p_m[i]);
  for (int i = 0; i < 4; ++i) text += "," + Number(T.q.coeffs()[i]);
  return text + "\n";
}

}  // namespace rigcal::importing
