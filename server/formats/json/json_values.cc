#include "server/formats/json/json_values.h"

#include <array>
#include <cmath>

namespace rigcal::formats {
namespace {

constexpr std::size_t kDiagnosesMax = 100'000;

void WriteNumbers(JsonWriter& out, const double* values, int count) {
  for (int i = 0; i < count; ++i) out.Number(values[i]);
}

void WriteGlobalError(JsonWriter& out, std::string_view key, const GlobalError& error) {
  out.Object(key, [&] {
    out.Number("rotation_rad2", error.rotation_rad2);
    out.Number("total", error.total);
    out.Number("translation_m2", error.translation_m2);
  });
}

void WriteSigmaGroup(JsonWriter& out, std::string_view key, const AxisSigma* sigmas) {
  out.List(key, [&] {
    for (int axis = 0; axis < 3; ++axis) sigmas[axis].known ? out.Number(sigmas[axis].value) : out.Null();
  });
}

void WriteSigmas(JsonWriter& out, const std::array<AxisSigma, 6>& sigmas) {
  WriteSigmaGroup(out, "sigma_m", &sigmas[tangent::kTranslation]);
  WriteSigmaGroup(out, "sigma_rad", &sigmas[tangent::kRotation]);
}

}  // namespace

void WriteVector(JsonWriter& out, std::string_view key, const Vector6d& values) {
  out.List(key, [&] { WriteNumbers(out, values.data(), 6); });
}

void WriteMatrix(JsonWriter& out, std::string_view key, const Matrix6d& matrix) {
  out.List(key, [&] {
    for (int row = 0; row < 6; ++row) {
      const Vector6d values = matrix.row(row).transpose();
      out.List([&] { WriteNumbers(out, values.data(), 6); });
    }
  });
}

void WriteLowerTriangle(JsonWriter& out, std::string_view key, const Eigen::MatrixXd& matrix) {
  out.List(key, [&] {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      const Eigen::VectorXd values = matrix.row(row).head(row + 1).transpose();
      out.List([&] { WriteNumbers(out, values.data(), static_cast<std::size_t>(values.size())); });
    }
  });
}

void WritePose(JsonWriter& out, std::string_view key, const Se3& T) {
  out.Object(key, [&] {
    out.List("p_m", [&] { WriteNumbers(out, T.p_m.data(), 3); });
    out.List("q_xyzw", [&] {
      for (const double value : {T.q.x(), T.q.y(), T.q.z(), T.q.w()}) out.Number(value);
    });
  });
}

void WriteStamp(JsonWriter& out, std::string_view key, const std::optional<Stamp>& stamp) {
  stamp ? out.Text(key, ToIso(*stamp)) : out.Null(key);
}

void WriteVerdict(JsonWriter& out, std::string_view key, const Verdict& verdict) {
  out.Object(key, [&] {
    out.Text("level", NameOf(verdict.level));
    if (!verdict.unverified.empty()) out.Text("unverified", verdict.unverified);
    out.Text("what_to_do", verdict.what_to_do);
    out.Text("why", verdict.why);
  });
}

void WriteDiagnoses(JsonWriter& out, std::string_view key, const std::vector<Diagnosis>& diagnoses) {
  out.List(key, [&] {
    for (const Diagnosis& diagnosis : diagnoses)
      out.Object([&] {
        out.Text("code", diagnosis.code);
        out.Text("cure", diagnosis.cure);
        out.Text("what", diagnosis.what);
      });
  });
}

void WriteWord(JsonWriter& out, const Word& word) {
  WriteStamp(out, "at", word.at);
  out.Text("who", word.who);
  out.Text("reason", word.reason);
}

void WriteErrorMembers(JsonWriter& out, const Error& error) {
  out.Text("code", NameOf(error.code));
  out.Text("cure", error.cure);
  out.Text("what", error.what);
}

void WriteGlobalErrors(JsonWriter& out, const GlobalError& before, const GlobalError& after) {
  out.Object("e_global", [&] {
    WriteGlobalError(out, "after", after);
    WriteGlobalError(out, "before", before);
  });
}

void WriteSigmas(JsonWriter& out, const Uncertainty& uncertainty) {
  std::array<AxisSigma, 6> sigmas;
  for (int axis = 0; axis < 6; ++axis) sigmas[static_cast<std::size_t>(axis)] = SigmaOf(uncertainty, axis);
  WriteSigmas(out, sigmas);
}

void WriteSigmas(JsonWriter& out, const Matrix6d& covariance) {
  std::array<AxisSigma, 6> sigmas;
  for (int axis = 0; axis < 6; ++axis)
    sigmas[static_cast<std::size_t>(axis)] = {true, std::sqrt(std::max(0.0, covariance(axis, axis)))};
  WriteSigmas(out, sigmas);
}

void WriteNoSigmas(JsonWriter& out) {
  out.Null("sigma_m");
  out.Null("sigma_rad");
}

void WriteRevisionNumber(JsonWriter& out, int revision) {
  revision > 0 ? out.Integer("revision", revision) : out.Null("revision");
}

Vector6d ReadVector(const JsonField& field) {
  Vector6d values = Vector6d::Zero();
  field.Numbers(values.data(), 6);
  return values;
}

Matrix6d ReadMatrix(const JsonField& field) {
  Matrix6d matrix = Matrix6d::Zero();
  const std::vector<JsonField> rows = field.Items(6);
  if (rows.size() != 6) {
    field.Refuse("must be 6 rows of 6 numbers");
    return matrix;
  }
  for (int row = 0; row < 6; ++row) matrix.row(row) = ReadVector(rows[static_cast<std::size_t>(row)]).transpose();
  return matrix;
}

Eigen::MatrixXd ReadLowerTriangle(const JsonField& field) {
  constexpr std::size_t kRowsMax = 60'000;
  const std::vector<JsonField> rows = field.Items(kRowsMax);
  const auto size = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd values(size);
  for (Eigen::Index row = 0; row < size; ++row) {
    rows[static_cast<std::size_t>(row)].Numbers(values.data(), static_cast<std::size_t>(row) + 1);
    lower.row(row).head(row + 1) = values.head(row + 1).transpose();
  }
  return lower.selfadjointView<Eigen::Lower>();
}

Se3 ReadPose(const JsonField& field, double tolerance) {
  Se3 T;
  std::array<double, 4> q_xyzw = {0, 0, 0, 1};
  field.At("p_m").Numbers(T.p_m.data(), 3);
  const JsonField quaternion = field.At("q_xyzw");
  quaternion.Numbers(q_xyzw.data(), 4);
  T.q = Eigen::Quaterniond(q_xyzw[3], q_xyzw[0], q_xyzw[1], q_xyzw[2]);
  if (!(std::abs(T.q.norm() - 1.0) <= tolerance))
    quaternion.Refuse("must have unit length (it is " + std::to_string(T.q.norm()) + ")");
  return T;
}

Verdict ReadVerdict(const JsonField& field) {
  const auto unverified = field.Find("unverified");
  return {VerdictLevelOf(field.At("level").Text()), field.At("why").Text(), field.At("what_to_do").Text(),
          unverified ? unverified->Text() : ""};
}

std::vector<Diagnosis> ReadDiagnoses(const JsonField& field) {
  std::vector<Diagnosis> diagnoses;
  for (const JsonField& item : field.Items(kDiagnosesMax))
    diagnoses.push_back({item.At("code").Text(), item.At("what").Text(), item.At("cure").Text()});
  return diagnoses;
}

GlobalError ReadGlobalError(const JsonField& field) {
  return {field.At("total").Number(), field.At("translation_m2").Number(), field.At("rotation_rad2").Number()};
}

Stamp ReadStamp(const JsonField& field) {
  const std::string text = field.Text();
  if (field.IsNull()) return {};
  const Result<Stamp> stamp = ParseIso(text);
  if (stamp) return *stamp;
  field.Refuse(stamp.error().what);
  return {};
}

}  // namespace rigcal::formats
