#include "server/formats/edges/g2o.h"

#include <array>
#include <cmath>
#include <set>

#include "server/base/limits.h"
#include "server/base/number_text.h"
#include "server/base/text.h"
#include "server/formats/edges/first_three.h"
#include "server/math/covariance.h"
#include "server/model/plausible.h"

namespace rigcal::formats {
namespace {

constexpr double kG2oUnitTolerance = 1e-3;

Vector6d HalfAngles() {
  Vector6d D;
  D << 1.0, 1.0, 1.0, 0.5, 0.5, 0.5;
  return D;
}

// One line of the file: its number, its fields and how far they were read.
class Line {
 public:
  Line(int number, std::string_view text) : number_(number), rest_(text) {}

  // The next field; empty at the end.
  std::string_view Next() {
    const std::size_t begin = rest_.find_first_not_of(" \t\r\v\f");
    if (begin == std::string_view::npos) return rest_ = {};
    const std::size_t end = std::min(rest_.find_first_of(" \t\r\v\f", begin), rest_.size());
    const std::string_view field = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return field;
  }

  [[nodiscard]] tl::unexpected<Error> Refuse(const std::string& what, std::string cure) const {
    const std::string subject = name_.empty() ? std::string() : name_ + ": ";
    return Fail(ErrorCode::kInvalidInput, "line " + std::to_string(number_) + ": " + subject + what, std::move(cure));
  }
  void Name(std::string name) { name_ = std::move(name); }
  [[nodiscard]] std::string Place() const { return "line " + std::to_string(number_) + " (" + name_ + ")"; }

  Result<std::int64_t> ReadVertex() {
    const std::string_view field = Next();
    const auto number = NumberIn<std::int64_t>(field);
    if (number && *number >= 0) return *number;
    return Refuse(Quoted(field) + " is not a vertex number", "Vertices are whole numbers from 0.");
  }

  template <std::size_t N>
  Status ReadNumbers(std::array<double, N>& numbers) {
    for (std::size_t k = 0; k < N; ++k) {
      const std::string_view field = Next();
      if (field.empty())
        return Refuse("ends after " + std::to_string(k) + " of " + std::to_string(N) + " numbers",
                      "The line is cut off: write the file again.");
      const auto number = NumberIn<double>(field);
      if (!number || !std::isfinite(*number))
        return Refuse(Quoted(field) + " is not a finite number", "Correct this field.");
      numbers[k] = *number;
    }
    return {};
  }

  Status ExpectEnd() {
    if (const std::string_view extra = Next(); !extra.empty())
      return Refuse("has more fields than expected, from " + Quoted(extra), "Write one record per line.");
    return {};
  }

 private:
  int number_;
  std::string_view rest_;
  std::string name_;
};

// "x y z qx qy qz qw", the first seven numbers.
Result<Se3> PoseFrom(const Line& line, const double* numbers) {
  Se3 T;
  T.p_m = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  T.q.coeffs() = Eigen::Vector4d(numbers[3], numbers[4], numbers[5], numbers[6]);
  if (const double norm = T.q.norm(); !(std::abs(norm - 1.0) <= kG2oUnitTolerance))
    return line.Refuse("the quaternion has length " + std::to_string(norm) + ", not 1",
                       "Normalise the quaternion; the order is qx qy qz qw.");
  if (const Status near = CheckPlausible(T.p_m); !near) return line.Refuse(near.error().what, near.error().cure);
  return T.Normalized();
}

// The upper triangle, row by row.
Matrix6d SymmetricFrom(const double* numbers) {
  Matrix6d matrix;
  for (int row = 0; row < 6; ++row)
    for (int col = row; col < 6; ++col) matrix(row, col) = matrix(col, row) = *numbers++;
  return matrix;
}

// Which sensor each vertex is: its number, or what a comment before its first use names it.
class VertexNames {
 public:
  // `line` behind its '#'. Any other comment says nothing.
  Status ReadComment(Line& line) {
    if (line.Next() != "vertex") return {};
    const auto number = NumberIn<std::int64_t>(line.Next());
    if (!number || *number < 0 || line.Next() != "is") return {};
    const auto name = SensorId::Parse(line.Next());
    if (!name || !line.ExpectEnd()) return {};
    line.Name("vertex " + std::to_string(*number));
    if (const auto known = sensors_.find(*number); known != sensors_.end() && known->second != *name)
      return line.Refuse("is named " + Quoted(name->str()) + ", and before it was " + Quoted(known->second.str()),
                         "Name each vertex once, before the first line that uses it.");
    return Keep(line, *number, *name);
  }
  Result<SensorId> Read(Line& line) {
    RIGCAL_ASSIGN(const std::int64_t number, line.ReadVertex());
    if (const auto known = sensors_.find(number); known != sensors_.end()) return known->second;
    SensorId own(std::to_string(number));
    RIGCAL_TRY(Keep(line, number, own));
    return own;
  }

 private:
  Status Keep(const Line& line, std::int64_t number, const SensorId& sensor) {
    sensors_.emplace(number, sensor);
    const auto [one, is_new] = vertices_.emplace(sensor, number);
    if (is_new || one->second == number) return {};
    return line.Refuse("vertices " + std::to_string(one->second) + " and " + std::to_string(number) + " are both " +
                           Quoted(sensor.str()),
                       "Name one of them otherwise, by a comment \"# vertex N is NAME\".");
  }

  std::map<std::int64_t, SensorId> sensors_;
  std::map<SensorId, std::int64_t> vertices_;
};

class Reader {
 public:
  explicit Reader(const RobotId& robot) : robot_(robot) {}

  Status ReadLine(Line line) {
    const std::string_view tag = line.Next();
    if (tag == "#") return names_.ReadComment(line);
    if (tag.empty() || tag.front() == '#') return {};
    if (tag == "EDGE_SE3:QUAT") return ReadEdge(line);
    if (tag == "VERTEX_SE3:QUAT") return ReadVertexPose(line);
    if (tag == "FIX") return ReadFix(line);
    return line.Refuse(Quoted(tag) + " is not supported", "Supported are EDGE_SE3:QUAT, VERTEX_SE3:QUAT and FIX.");
  }

  Result<G2oFile> Finish() {
    RIGCAL_TRY(CheckDefinite());
    if (file_.edges.empty())
      return Fail(ErrorCode::kInvalidInput, "the file has no EDGE_SE3:QUAT line", "Give a .g2o file with 3D edges.");
    if (sensors_.size() > limits::kSensorsPerRobotMax)
      return Fail(ErrorCode::kInvalidInput, "the file has " + std::to_string(sensors_.size()) + " vertices",
                  "At most " + std::to_string(limits::kSensorsPerRobotMax) + " sensors per robot: split the graph.");
    AssignPushedIds(file_.edges);
    return std::move(file_);
  }

 private:
  Status ReadEdge(Line& line) {
    Edge edge;
    edge.robot = robot_;
    edge.method = "g2o";
    edge.state = EdgeState::kGood;
    RIGCAL_ASSIGN(edge.frame_a, names_.Read(line));
    RIGCAL_ASSIGN(edge.frame_b, names_.Read(line));
    line.Name("edge " + edge.frame_a.str() + " - " + edge.frame_b.str());
    if (edge.frame_a == edge.frame_b) return line.Refuse("joins a vertex with itself", "Remove this line.");
    std::array<double, 28> numbers{};
    RIGCAL_TRY(line.ReadNumbers(numbers));
    RIGCAL_TRY(line.ExpectEnd());
    RIGCAL_ASSIGN(edge.T_a_b, PoseFrom(line, numbers.data()));
    const Matrix6d Omega_g2o = SymmetricFrom(numbers.data() + 7);
    if (++edges_read_ > limits::kEdgesPerBatchMax)
      return line.Refuse("is beyond the limit of " + std::to_string(limits::kEdgesPerBatchMax) + " edges",
                         "Split the file.");
    if (!Judge(Omega_g2o)) {
      indefinite_.push_back(line);
      return {};
    }
    RIGCAL_TRY(SetInformation(line, edge));
    sensors_.insert({edge.frame_a, edge.frame_b});
    file_.edges.push_back(std::move(edge));
    return {};
  }

  // Whether it is definite. Files repeat one matrix over and over: what it says is worked out once. Judged as the edge
  // will be; g2o's own scale may hide a small negative.
  bool Judge(const Matrix6d& Omega_g2o) {
    if (edges_read_ > 1 && Omega_g2o == last_Omega_g2o_) return last_definite_;
    last_Omega_g2o_ = Omega_g2o;
    const Matrix6d Omega = InformationFromG2o(Omega_g2o);
    last_definite_ = IsPositiveSemidefinite(Omega);
    last_plausible_ = CheckPlausible(Omega);
    if (last_definite_ && last_plausible_) last_ = FromInformation(Omega, UncertaintySource::kGiven, 0);
    return last_definite_;
  }

  Status SetInformation(const Line& line, Edge& edge) {
    if (!last_plausible_) return line.Refuse(last_plausible_.error().what, last_plausible_.error().cure);
    if (!last_.covariance.allFinite())
      return line.Refuse("the information matrix is too badly conditioned to invert",
                         "Check the units of its entries; they are for m and rad.");
    if (last_.rank < 1)
      return line.Refuse("the information matrix is zero", "An edge without information says nothing: remove it.");
    edge.uncertainty = last_;
    return {};
  }

  // All of them at once: who mends the first should not meet the second.
  [[nodiscard]] Status CheckDefinite() const {
    if (indefinite_.empty()) return {};
    const std::string cure = "An information matrix has no negative eigenvalue: correct it where it was made.";
    if (indefinite_.size() == 1) return indefinite_.front().Refuse("the information matrix is indefinite", cure);
    return Fail(ErrorCode::kInvalidInput,
                std::to_string(indefinite_.size()) + " of " + std::to_string(edges_read_) +
                    " edges have an indefinite information matrix: " +
                    FirstThree(indefinite_.size(), [&](std::size_t i) { return indefinite_[i].Place(); }),
                cure);
  }

  Status ReadVertexPose(Line& line) {
    RIGCAL_ASSIGN(const SensorId vertex, names_.Read(line));
    line.Name("vertex " + vertex.str());
    std::array<double, 7> numbers{};
    RIGCAL_TRY(line.ReadNumbers(numbers));
    RIGCAL_TRY(line.ExpectEnd());
    RIGCAL_ASSIGN(const Se3 T_world_vertex, PoseFrom(line, numbers.data()));
    if (!file_.T_world_vertex.emplace(vertex, T_world_vertex).second)
      return line.Refuse("occurs twice", "Remove one of the two lines.");
    return {};
  }

  Status ReadFix(Line& line) {
    RIGCAL_ASSIGN(const SensorId vertex, names_.Read(line));
    if (file_.fixed.empty()) file_.fixed = vertex;
    while (!line.Next().empty()) {
    }
    return {};
  }

  RobotId robot_;
  VertexNames names_;
  G2oFile file_;
  std::set<SensorId> sensors_;
  std::size_t edges_read_ = 0;
  std::vector<Line> indefinite_;
  Matrix6d last_Omega_g2o_ = Matrix6d::Zero();
  bool last_definite_ = true;
  Status last_plausible_;
  Uncertainty last_;
};

}  // namespace

Matrix6d InformationFromG2o(const Matrix6d& Omega_g2o) {
  return HalfAngles().asDiagonal() * Omega_g2o * HalfAngles().asDiagonal();
}

Matrix6d InformationToG2o(const Matrix6d& Omega) {
  const Vector6d inverse = HalfAngles().cwiseInverse();
  return inverse.asDiagonal() * Omega * inverse.asDiagonal();
}

Result<G2oFile> ReadG2o(std::string_view text, const RobotId& robot) {
  if (text.size() > limits::kG2oFileBytesMax)
    return Fail(ErrorCode::kInvalidInput, "the file is larger than 1 GiB", "Split the graph.");
  Reader reader(robot);
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    RIGCAL_TRY(reader.ReadLine(Line(number, text.substr(0, end))));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.Finish();
}

}  // namespace rigcal::formats
