#include <array>
#include <charconv>
#include <cmath>

#include "server/report/edges/page_data.h"
#include "server/report/text/edge_axes.h"
#include "server/report/text/edge_state.h"
#include "server/report/text/figure_words.h"
#include "server/report/text/influence.h"

namespace rigcal::report {
namespace {

std::string Number(double value) {
  if (!std::isfinite(value)) return "";
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 9).ptr};
}

std::string SixNumbers(const Vector6d& values, bool known) {
  std::string text;
  for (int axis = 0; axis < 6; ++axis) text += "," + (known ? Number(values(axis)) : std::string());
  return text;
}

std::string SixSigmas(const Edge& edge) {
  std::string text;
  for (int axis = 0; axis < 6; ++axis) {
    const AxisSigma sigma = SigmaOf(edge.uncertainty, axis);
    text += "," + (sigma.known && edge.state == EdgeState::kGood ? Number(sigma.value) : std::string());
  }
  return text;
}

// Is it checked; the sensor that moves most without it, and by how much.
std::string WithoutEdge(const Influences& influences, const EdgeId& id) {
  const EdgeInfluence* found = InfluenceOf(influences, id);
  if (found == nullptr) return ",,,,,";
  if (!found->checked || found->most_moved.empty()) return std::string(found->checked ? ",yes" : ",no") + ",,,,";
  return ",yes," + CsvField(found->most_moved.str()) + "," + Number(found->move.head<3>().norm()) + "," +
         Number(found->move.tail<3>().norm()) + "," + Number(found->move_sigmas);
}

// The capture that matters most to the edge, and by how much its position moves without it.
std::string WithoutCapture(const ReportInput& input, const Edge& edge) {
  const auto blocks = input.blocks.find(edge.id);
  if (edge.state != EdgeState::kGood || blocks == input.blocks.end() || blocks->second.empty()) return ",,";
  const Influence largest = LargestInfluence(blocks->second, edge.uncertainty);
  return "," + CsvField(largest.block_id) + "," + Number(largest.position_m);
}

std::string CsvRow(const ReportInput& input, const ShownEdge& shown) {
  const Edge& edge = *shown.edge;
  const bool good = edge.state == EdgeState::kGood;
  std::string row = CsvField(edge.frame_a.str()) + "," + CsvField(edge.frame_b.str()) + "," + StateWord(edge) + "," +
                    CsvField(edge.method + (IsPolished(edge) ? "+gicp" : "")) + "," +
                    (good ? NameOf(edge.uncertainty.source) : "");
  Vector6d pose;
  pose << edge.T_a_b.p_m, edge.T_a_b.q.x(), edge.T_a_b.q.y(), edge.T_a_b.q.z();
  row += SixNumbers(pose, good) + "," + (good ? Number(edge.T_a_b.q.w()) : "") + SixSigmas(edge);
  row += SixNumbers(shown.residual ? shown.residual->e : Vector6d::Zero(), shown.residual != nullptr);
  const auto test = input.limits.find(edge.id);
  const bool tested = test != input.limits.end() && test->second.limit > 0.0;
  row += "," + (tested ? Number(test->second.statistic) + "," + Number(test->second.limit) : std::string(","));
  row += "," + CsvField(edge.id.str()) + "," + CsvField(edge.session.str());
  return row + WithoutEdge(input.revision.solution.influences, edge.id) + WithoutCapture(input, edge) + "\r\n";
}

}  // namespace

std::string CsvField(const std::string& text) {
  std::string field = text;
  if (!field.empty() && std::string("=+-@\t\r").find(field.front()) != std::string::npos) field.insert(0, "'");
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

std::string EdgeCsv(const ReportInput& input, const std::vector<ShownEdge>& edges) {
  std::string text =
      "frame_a,frame_b,state,method,sigma_source,x_m,y_m,z_m,qx,qy,qz,qw,sigma_x_m,sigma_y_m,sigma_z_m,sigma_rx_rad,"
      "sigma_ry_rad,sigma_rz_rad,residual_x_m,residual_y_m,residual_z_m,residual_rx_rad,residual_ry_rad,residual_rz_"
      "rad,"
      "statistic,limit,edge,session,checked,without_edge_sensor,without_edge_m,without_edge_rad,without_edge_sigmas,"
      "without_capture,without_capture_m\r\n";
  for (const ShownEdge& shown : edges) text += CsvRow(input, shown);
  return text;
}

}  // namespace rigcal::report
