#include "server/model/sensors/cloud_layout.h"

#include <algorithm>
#include <set>

#include "server/base/limits.h"
#include "server/base/text.h"

namespace rigcal {
namespace {

constexpr std::size_t kFieldsMin = 3, kFieldsMax = 8;
constexpr const char* kFieldsCure = "Name what a point holds, in the file's order, such as [x, y, z, intensity, ring].";

Status RefuseFields(const std::string& what) { return Fail(ErrorCode::kInvalidInput, "fields: " + what, kFieldsCure); }

}  // namespace

std::string NameOf(PointType type) { return type == PointType::kFloat64 ? "float64" : "float32"; }

Result<PointType> PointTypeOf(const std::string& name) {
  for (const PointType type : {PointType::kFloat32, PointType::kFloat64})
    if (NameOf(type) == name) return type;
  return Fail(ErrorCode::kInvalidInput, "the type " + Quoted(name) + " of numbers is not known",
              "Use float32 (4 bytes a number, as if it were left away) or float64 (8 bytes).");
}

CloudLayout KittiLayout() { return {{"x", "y", "z", "intensity"}, PointType::kFloat32}; }

std::string TextOf(const CloudLayout& layout) {
  std::string text;
  for (const std::string& field : layout.fields) text += (text.empty() ? "" : " ") + field;
  return text + ", " + NameOf(layout.type);
}

Status Validate(const CloudLayout& layout) {
  if (layout.fields.size() < kFieldsMin || layout.fields.size() > kFieldsMax)
    return RefuseFields("a point has 3 to 8 numbers, not " + std::to_string(layout.fields.size()));
  std::set<std::string_view> names;
  for (const std::string& field : layout.fields) {
    if (field.empty() || field.size() > limits::kNameMax || !IsPrintableUtf8(field))
      return RefuseFields("the name " + Quoted(field) + " is empty, too long or not printable");
    if (!names.insert(field).second) return RefuseFields(Quoted(field) + " occurs twice");
  }
  for (const char* axis : {"x", "y", "z"})
    if (!names.contains(axis)) return RefuseFields(Quoted(axis) + " is missing");
  return {};
}

}  // namespace rigcal
