// How the values that files of several kinds share look in YAML, as people write them.
#pragma once

#include <string>

#include "server/formats/yaml/yaml_field.h"
#include "server/math/se3.h"

namespace rigcal::formats {

// An id, checked.
template <typename IdType>
[[nodiscard]] IdType ReadId(const YamlField& field) {
  const auto id = IdType::Parse(field.Text());
  if (!id) field.Refuse(id.error().what, id.error().cure);
  return id.value_or(IdType());
}
// What a text names by `of` (SensorKindOf, ...); `otherwise` where that knows no such name, which is refused.
template <typename T>
[[nodiscard]] T ReadNamed(const YamlField& field, Result<T> (*of)(const std::string&), T otherwise) {
  const Result<T> named = of(field.Text());
  if (!named) field.Refuse(named.error().what, named.error().cure);
  return named.value_or(otherwise);
}
// [x, y, z, w], as it stands: of unit length to the few digits that a person writes (1e-3).
[[nodiscard]] Eigen::Quaterniond ReadQuaternion(const YamlField& field);

}  // namespace rigcal::formats
