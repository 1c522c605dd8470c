// How the values that many documents share look in JSON (docs/api.md, rules).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/approval/standing.h"
#include "server/model/diagnosis.h"
#include "server/model/edges/uncertainty.h"
#include "server/model/graph/graph.h"

namespace rigcal::formats {

// A list of six numbers, translation first.
void WriteVector(JsonWriter& out, std::string_view key, const Vector6d& values);
void WriteMatrix(JsonWriter& out, std::string_view key, const Matrix6d& matrix);  // 6 rows of 6
// Rows of the lower triangle, the diagonal with it: row k has k + 1 numbers.
void WriteLowerTriangle(JsonWriter& out, std::string_view key, const Eigen::MatrixXd& matrix);
void WritePose(JsonWriter& out, std::string_view key, const Se3& T);  // {"p_m", "q_xyzw"}
void WriteStamp(JsonWriter& out, std::string_view key, const std::optional<Stamp>& stamp);
void WriteVerdict(JsonWriter& out, std::string_view key, const Verdict& verdict);
void WriteDiagnoses(JsonWriter& out, std::string_view key, const std::vector<Diagnosis>& diagnoses);
void WriteErrorMembers(JsonWriter& out, const Error& error);  // code, what, cure
void WriteWord(JsonWriter& out, const Word& word);            // at, who, reason
// A list of ids, in the order of the container.
template <typename Ids>
void WriteIds(JsonWriter& out, std::string_view key, const Ids& ids) {
  out.List(key, [&] {
    for (const auto& id : ids) out.Text(id.str());
  });
}
// "e_global": {"before", "after"} of {"total", "translation_m2", "rotation_rad2"}.
void WriteGlobalErrors(JsonWriter& out, const GlobalError& before, const GlobalError& after);
// "sigma_m" and "sigma_rad", three values each; an unobservable axis is null.
void WriteSigmas(JsonWriter& out, const Uncertainty& uncertainty);
void WriteSigmas(JsonWriter& out, const Matrix6d& covariance);
void WriteNoSigmas(JsonWriter& out);
// A revision's number; 0, "none yet", is null.
void WriteRevisionNumber(JsonWriter& out, int revision);

// What the writer of that name wrote; anything else is refused at its field. A lower triangle becomes a symmetric
// matrix.
[[nodiscard]] Vector6d ReadVector(const JsonField& field);
[[nodiscard]] Matrix6d ReadMatrix(const JsonField& field);
[[nodiscard]] Eigen::MatrixXd ReadLowerTriangle(const JsonField& field);
// The numbers as they stand; the quaternion must have unit length to `tolerance`.
[[nodiscard]] Se3 ReadPose(const JsonField& field, double tolerance);
[[nodiscard]] Verdict ReadVerdict(const JsonField& field);
[[nodiscard]] std::vector<Diagnosis> ReadDiagnoses(const JsonField& field);
[[nodiscard]] GlobalError ReadGlobalError(const JsonField& field);
[[nodiscard]] Stamp ReadStamp(const JsonField& field);

constexpr double kUnitTolerance = 1e-6;  // of what this program wrote

// An id, checked. The field's path is in the error.
template <typename IdType>
[[nodiscard]] IdType ReadId(const JsonField& field) {
  const std::string text = field.Text();
  if (field.IsNull()) return IdType();
  auto id = IdType::Parse(text);
  if (id) return *std::move(id);
  field.Refuse(id.error().what);
  return IdType();
}
// What a text names by `of` (SensorKindOf, ...); `otherwise` where that knows no such name, which is refused.
template <typename T>
[[nodiscard]] T ReadNamed(const JsonField& field, Result<T> (*of)(const std::string&), T otherwise) {
  const Result<T> named = of(field.Text());
  if (!named) field.Refuse(named.error().what);
  return named.value_or(otherwise);
}
// A list of at most `count_max` ids, in the order of the document.
template <typename IdType>
[[nodiscard]] std::vector<IdType> ReadIds(const JsonField& field, std::size_t count_max) {
  std::vector<IdType> ids;
  for (const JsonField& id : field.Items(count_max)) ids.push_back(ReadId<IdType>(id));
  return ids;
}
// Empty where there is no such member.
template <typename IdType>
[[nodiscard]] IdType ReadOptionalId(const JsonField& parent, const std::string& name) {
  const auto field = parent.Find(name);
  return field ? ReadId<IdType>(*field) : IdType();
}

}  // namespace rigcal::formats
