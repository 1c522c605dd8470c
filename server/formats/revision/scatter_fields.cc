#include "server/formats/revision/scatter_fields.h"

#include <algorithm>
#include <climits>

namespace rigcal::formats {
namespace {

void WriteScatterOfAxes(JsonWriter& out, std::string_view key, const ScatterOfAxes& scatter, bool turns) {
  out.Object(key, [&] {
    out.Number(turns ? "between_rad2" : "between_m2", scatter.between);
    out.Number("dof", scatter.dof);
    out.Number(turns ? "own_rad2" : "own_m2", scatter.own);
    if (!scatter.TellsAxes()) return;
    out.List("ratio", [&] {
      for (const double of_axis : scatter.ratio) out.Number(of_axis);
    });
  });
}

ScatterOfAxes ReadScatterOfAxes(const JsonField& field, bool turns) {
  ScatterOfAxes scatter{field.At(turns ? "between_rad2" : "between_m2").Number(),
                        field.At(turns ? "own_rad2" : "own_m2").Number(), field.At("dof").Number()};
  if (const auto ratio = field.Find("ratio")) ratio->Numbers(scatter.ratio.data(), scatter.ratio.size());
  return scatter;
}

void WriteVisitScatter(JsonWriter& out, std::string_view key, const VisitScatter& scatter) {
  out.Object(key, [&] {
    out.Integer("robots", scatter.robots);
    WriteScatterOfAxes(out, "rotation", scatter.rotation, true);
    WriteScatterOfAxes(out, "translation", scatter.translation, false);
  });
}

VisitScatter ReadVisitScatter(const JsonField& field) {
  return {ReadScatterOfAxes(field.At("translation"), false), ReadScatterOfAxes(field.At("rotation"), true),
          static_cast<int>(field.At("robots").Integer(1, INT_MAX))};
}

void WriteThree(JsonWriter& out, std::string_view key, const Vector6d& variance, Eigen::Index first) {
  out.List(key, [&] {
    for (Eigen::Index axis = first; axis < first + 3; ++axis) out.Number(variance(axis));
  });
}

void ReadScatterTaken(const JsonField& field, FusedPose& fused) {
  const auto taken = field.Find("visit_scatter");
  if (!taken) return;
  fused.scatter_dof = {taken->At("dof_translation").Number(), taken->At("dof_rotation").Number()};
  Vector6d variance;
  taken->At("translation_m2").Numbers(variance.data() + tangent::kTranslation, 3);
  taken->At("rotation_rad2").Numbers(variance.data() + tangent::kRotation, 3);
  fused.visit_variance = variance;
}

}  // namespace

void WritePooledScatter(JsonWriter& out, const FusedPose& fused) {
  if (!fused.pooled_scatter) return;
  out.Object("scatter", [&] {
    out.Number("dof_rotation", fused.scatter_dof.rotation);
    out.Number("dof_translation", fused.scatter_dof.translation);
    WriteVisitScatter(out, "own", fused.scatter);
    WriteVisitScatter(out, "pooled", *fused.pooled_scatter);
  });
}

void WriteScatterTaken(JsonWriter& out, const FusedPose& fused) {
  const bool by_itself = !fused.pooled_scatter && fused.scatter_dof.translation > 0;
  if (!by_itself && !fused.visit_variance) return;
  const Vector6d variance =
      fused.visit_variance.value_or(EachAxis(fused.visit_sigma_m, fused.visit_sigma_rad).cwiseAbs2());
  out.Object("visit_scatter", [&] {
    out.Number("dof_rotation", fused.scatter_dof.rotation);
    out.Number("dof_translation", fused.scatter_dof.translation);
    WriteThree(out, "rotation_rad2", variance, tangent::kRotation);
    WriteThree(out, "translation_m2", variance, tangent::kTranslation);
  });
}

void ReadScatter(const JsonField& field, FusedPose& fused) {
  const double own = 3.0 * std::max(0, fused.sessions - 1);
  fused.scatter_dof = {own, own};
  ReadScatterTaken(field, fused);
  const auto scatter = field.Find("scatter");
  if (!scatter) return;
  fused.scatter_dof = {scatter->At("dof_translation").Number(), scatter->At("dof_rotation").Number()};
  fused.scatter = ReadVisitScatter(scatter->At("own"));
  fused.pooled_scatter = ReadVisitScatter(scatter->At("pooled"));
}

}  // namespace rigcal::formats
