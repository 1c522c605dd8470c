#include <array>
#include <charconv>
#include <set>

#include "server/base/number_text.h"
#include "server/formats/edges/g2o.h"

namespace rigcal::formats {
namespace {

std::int64_t VertexNumberOf(const SensorId& sensor) {
  const std::string& name = sensor.str();
  const auto number = NumberIn<std::int64_t>(name);
  return number && std::to_string(*number) == name ? *number : -1;  // "007" would come back as "7"
}

// Every sensor once: in the order of the poses, then of the edges.
std::vector<SensorId> SensorsToWrite(const std::vector<Edge>& edges, const std::vector<SensorPose>& poses) {
  std::vector<SensorId> sensors;
  std::set<SensorId> seen;
  const auto take = [&](const SensorId& sensor) {
    if (seen.insert(sensor).second) sensors.push_back(sensor);
  };
  for (const SensorPose& pose : poses) take(pose.sensor);
  for (const Edge& edge : edges) take(edge.frame_a), take(edge.frame_b);
  return sensors;
}

class G2oText {
 public:
  explicit G2oText(const std::vector<SensorId>& sensors) {
    bool numbered = true;
    for (const SensorId& sensor : sensors) numbered = numbered && VertexNumberOf(sensor) >= 0;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      const std::string vertex = numbered ? sensors[k].str() : std::to_string(k);
      if (!numbered) text_ += "# vertex " + vertex + " is " + sensors[k].str() + "\n";
      vertices_.emplace(sensors[k], vertex);
    }
  }

  void Pose(const SensorId& sensor, const Se3& T_ref_sensor) {
    text_ += "VERTEX_SE3:QUAT " + vertices_.at(sensor);
    Numbers(T_ref_sensor);
    text_ += '\n';
  }
  void NotMeasured(const SensorId& sensor, const Vector6d& direction) {
    text_ += "# vertex " + vertices_.at(sensor) + " holds, not measured (its own x y z in m, rx ry rz in rad):";
    for (const double value : direction) Number(value);
    text_ += '\n';
  }
  void Fix(const SensorId& sensor) {
    if (const auto vertex = vertices_.find(sensor); vertex != vertices_.end()) text_ += "FIX " + vertex->second + "\n";
  }
  void Measured(const Edge& edge) {
    text_ += "EDGE_SE3:QUAT " + vertices_.at(edge.frame_a) + " " + vertices_.at(edge.frame_b);
    Numbers(edge.T_a_b);
    const Matrix6d Omega_g2o = InformationToG2o(edge.uncertainty.Omega);
    for (int row = 0; row < 6; ++row)
      for (int col = row; col < 6; ++col) Number(Omega_g2o(row, col));
    text_ += '\n';
  }
  [[nodiscard]] std::string Finish() { return std::move(text_); }

 private:
  void Numbers(const Se3& T) {
    for (const double value : T.p_m) Number(value);
    for (const double value : T.q.coeffs()) Number(value);
  }
  // The shortest text that is read as the same number.
  void Number(double value) {
    std::array<char, 32> text{};
    const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
    text_ += ' ';
    text_.append(text.data(), written.ptr);
  }

  std::map<SensorId, std::string> vertices_;
  std::string text_;
};

}  // namespace

Result<std::string> WriteG2o(const std::vector<Edge>& edges, const std::vector<SensorPose>& poses,
                             const SensorId& reference) {
  std::vector<Edge> good;
  for (const Edge& edge : edges)
    if (edge.state == EdgeState::kGood) good.push_back(edge);
  if (good.empty())
    return Fail(ErrorCode::kNotFound, "there is no good edge to write", "Push a session or finished edges first.");
  G2oText writer(SensorsToWrite(good, poses));
  for (const SensorPose& pose : poses) {
    if (pose.Placed() == nullptr) continue;
    for (const Vector6d& direction : pose.unobservable_basis) writer.NotMeasured(pose.sensor, direction);
    writer.Pose(pose.sensor, *pose.Placed());
  }
  writer.Fix(reference);
  for (const Edge& edge : good) writer.Measured(edge);
  return writer.Finish();
}

}  // namespace rigcal::formats
