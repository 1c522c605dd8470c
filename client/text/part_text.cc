#include "client/text/part_text.h"

#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/model/graph/measured_part.h"

namespace rigcal::client {
namespace {

constexpr const char* kNotMeasured = "not measured";

Eigen::Vector3d VectorFrom(const Document& list) {
  Eigen::Vector3d values;
  for (Eigen::Index k = 0; k < 3; ++k) values[k] = list[static_cast<std::size_t>(k)].Number().value_or(0.0);
  return values;
}

std::vector<AxisResult> AxesFrom(const Document& told) {
  std::vector<AxisResult> axes;
  for (const Document& axis : told["measured_part"]["axes"].Items()) {
    AxisResult& result = axes.emplace_back();
    result.name = axis["name"].Text();
    result.turn = axis.Has("sigma_rad");
    result.direction = VectorFrom(axis["direction"]);
    result.position_m = axis["position_m"].Number();
    result.sigma_m = axis["sigma_m"].Number();
    result.sigma_rad = axis["sigma_rad"].Number();
  }
  return axes;
}

std::optional<Eigen::Matrix3d> AxesOfRobotFrom(const Document& robot_axes) {
  if (robot_axes.IsNull()) return std::nullopt;
  Eigen::Matrix3d R;
  R << VectorFrom(robot_axes["forward"]), VectorFrom(robot_axes["left"]), VectorFrom(robot_axes["up"]);
  return R;
}

std::string JoinedByAnd(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  return text;
}

// Of what is itself an estimate.
std::string WithTwoDigits(double value, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), std::abs(value) < 9.95 ? "%.2g %s" : "%.0f %s", value, unit);
  return text.data();
}

std::string RestText(const std::vector<AxisResult>& axes) {
  const RestSigma rest = WorstSigmaOf(axes);
  std::vector<std::string> sigmas;
  if (rest.m) sigmas.push_back(WithTwoDigits(*rest.m * kMmPerM, "mm"));
  if (rest.rad) sigmas.push_back(WithTwoDigits(*rest.rad * kDegPerRad, "deg"));
  return sigmas.empty() ? "" : "; the rest is good to " + JoinedByAnd(sigmas);
}

std::string SigmaCell(const AxisResult& axis) {
  if (axis.sigma_rad) return Scaled(axis.sigma_rad, kDegPerRad, 4) + " deg";
  return axis.sigma_m ? Scaled(axis.sigma_m, kMmPerM, 3) + " mm" : kNotMeasured;
}

}  // namespace

bool IsInPart(const Document& told) { return !told["known"].Flag(true) && told["measured_part"]["axes"].size() > 0; }

std::string OpenText(const Document& told) {
  return JoinedByAnd(NamesOfOpen(AxesFrom(told), told["unobservable_basis"].size())) + " " + kNotMeasured;
}

std::string PartSentence(const Document& told, const std::string& whose) {
  const std::vector<AxisResult> axes = AxesFrom(told);
  const std::size_t open_count = told["unobservable_basis"].size();
  std::vector<std::string> names = NamesOfOpen(axes, open_count);
  for (std::string& name : names) name = InSentence(name);
  std::string text = JoinedByAnd(names);
  if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  const char* verb = names.size() > 1 || open_count > 1 ? " were " : " was ";
  return text + " of " + Plain(whose) + verb + kNotMeasured + RestText(axes) + ".";
}

std::string PartRpyText(const Document& told, int digits) {
  const Document part = told["measured_part"];
  return TurnsMeasured(AxesFrom(told)) ? RpyText(part.Has("T_a_b") ? part["T_a_b"] : part["T_ref_sensor"], digits)
                                       : "-";
}

void PrintPart(const Document& told, const Document& robot_axes, std::ostream& out) {
  const auto R = AxesOfRobotFrom(robot_axes);
  Table table({{"  ALONG, ABOUT"}, {"DIRECTION", Align::kRight}, {"AT mm", Align::kRight}, {"SIGMA", Align::kRight}});
  for (const AxisResult& axis : AxesFrom(told)) {
    const Eigen::Vector3d& d = axis.direction;
    table.Add({"  " + LabelOf(axis, R), Fixed(d.x(), 3) + " " + Fixed(d.y(), 3) + " " + Fixed(d.z(), 3),
               axis.turn ? "" : Scaled(axis.position_m, kMmPerM, 2), SigmaCell(axis)});
  }
  table.Print(out);
}

void PrintParts(const Document& revision, std::ostream& out) {
  for (const Document& sensor : revision["sensors"].Items()) {
    if (!IsInPart(sensor)) continue;
    const bool by_robot = !revision["robot_axes"].IsNull();
    const std::string whose =
        sensor["id"].Text("?") + (by_robot ? "" : " in the frame of " + revision["reference"].Text("?"));
    out << '\n' << PartSentence(sensor, whose) << '\n';
    PrintPart(sensor, revision["robot_axes"], out);
  }
}

}  // namespace rigcal::client
