#include "storage/revisions/revision_poses.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr char kBetweenIds = '/';

std::string Subject(const RevisionKey& key) {
  return "poses of revision " + std::to_string(key.number) + " of robot " + key.robot.str();
}

std::string Joined(const std::vector<SensorId>& sensors) {
  std::string joined;
  for (const SensorId& sensor : sensors) joined += (joined.empty() ? "" : std::string(1, kBetweenIds)) + sensor.str();
  return joined;
}

std::vector<SensorId> Split(const std::string& joined) {
  std::vector<SensorId> sensors;
  for (std::size_t first = 0; first < joined.size();) {
    const std::size_t end = std::min(joined.find(kBetweenIds, first), joined.size());
    sensors.emplace_back(joined.substr(first, end - first));
    first = end + 1;
  }
  return sensors;
}

Blob LowerOf(const Eigen::MatrixXd& matrix) {
  std::vector<double> values;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column <= row; ++column) values.push_back(matrix(row, column));
  return BlobOf(values.data(), values.size());
}

Result<Eigen::MatrixXd> WholeOf(const std::vector<double>& lower, std::size_t sensors) {
  const auto rows = static_cast<Eigen::Index>(6 * sensors);
  if (static_cast<Eigen::Index>(lower.size()) != rows * (rows + 1) / 2)
    return Fail(ErrorCode::kStorage, "a joint covariance is not of the size of its sensors",
                "Restore rigcal.db from a backup.");
  Eigen::MatrixXd matrix(rows, rows);
  auto value = lower.begin();
  for (Eigen::Index row = 0; row < rows; ++row)
    for (Eigen::Index column = 0; column <= row; ++column) matrix(row, column) = matrix(column, row) = *value++;
  return matrix;
}

Se3 PoseAt(const Query& query, int column) {
  const auto real = [&](int offset) { return query.Real(column + offset); };
  return {{real(0), real(1), real(2)}, Eigen::Quaterniond(real(6), real(3), real(4), real(5))};
}

}  // namespace

Status AppendRevisionPoses(Store& store, const RevisionKey& key, const JointPoses& poses) {
  return store.connection().Append(Subject(key), [&]() -> Status {
    for (const auto& [sensor, T] : poses.T_ref_sensor)
      Query(store, "INSERT INTO revision_pose VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
          .Bind(key.robot, key.number, sensor, sensor == poses.reference, T.p_m.x(), T.p_m.y(), T.p_m.z(), T.q.x(),
                T.q.y(), T.q.z(), T.q.w())
          .Run();
    int idx = 0;
    for (const JointCovariance& covariance : poses.covariances)
      Query(store, "INSERT INTO revision_covariance VALUES (?, ?, ?, ?, ?)")
          .Bind(key.robot, key.number, idx++, Joined(covariance.sensors), LowerOf(covariance.matrix))
          .Run();
    return {};
  });
}

Result<std::optional<JointPoses>> LoadRevisionPoses(Store& store, const RevisionKey& key) {
  using Poses = std::optional<JointPoses>;
  return Load<Poses>(store, Subject(key), [&]() -> Result<Poses> {
    JointPoses poses;
    Query pose(store,
               "SELECT sensor_id, is_reference, T_ref_sensor_x_m, T_ref_sensor_y_m, T_ref_sensor_z_m, T_ref_sensor_qx, "
               "T_ref_sensor_qy, T_ref_sensor_qz, T_ref_sensor_qw FROM revision_pose WHERE robot_id = ? AND "
               "revision_number = ?");
    pose.Bind(key.robot, key.number);
    while (pose.Step()) {
      if (pose.Int(1) != 0) poses.reference = pose.IdAt<SensorId>(0);
      poses.T_ref_sensor.emplace(pose.IdAt<SensorId>(0), PoseAt(pose, 2));
    }
    if (poses.T_ref_sensor.empty()) return std::nullopt;
    Query query(
        store,
        "SELECT sensors, lower FROM revision_covariance WHERE robot_id = ? AND revision_number = ? ORDER BY idx");
    query.Bind(key.robot, key.number);
    while (query.Step()) {
      JointCovariance covariance{Split(query.Text(0)), {}};
      RIGCAL_ASSIGN(covariance.matrix, WholeOf(query.Doubles(1), covariance.sensors.size()));
      poses.covariances.push_back(std::move(covariance));
    }
    return poses;
  });
}

}  // namespace rigcal::storage
