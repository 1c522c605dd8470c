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

Blob BlobOfPoses(const std::vector<Se3>& poses) {
  std::vector<double> values;
  for (const Se3& T : poses) {
    values.insert(values.end(), T.p_m.data(), T.p_m.data() + 3);
    values.insert(values.end(), T.q.coeffs().data(), T.q.coeffs().data() + 4);
  }
  return BlobOf(values.data(), values.size());
}

Error DamagedPoses(const RevisionKey& key) {
  return {ErrorCode::kStorage, Subject(key) + " are not of the size of its sensors",
          "Restore rigcal.db from a backup."};
}

Result<std::vector<Se3>> PosesOf(const RevisionKey& key, const std::vector<double>& values, std::size_t sensors) {
  if (values.size() != 7 * sensors) return Fail(DamagedPoses(key));
  std::vector<Se3> poses(sensors);
  for (std::size_t k = 0; k < sensors; ++k) {
    poses[k].p_m = Eigen::Map<const Eigen::Vector3d>(values.data() + 7 * k);
    poses[k].q.coeffs() = Eigen::Map<const Eigen::Vector4d>(values.data() + 7 * k + 3);
  }
  return poses;
}

Result<Eigen::MatrixXd> MotionsOf(const RevisionKey& key, const std::vector<double>& values, std::size_t sensors) {
  if (sensors == 0 || values.size() % (6 * sensors) != 0) return Fail(DamagedPoses(key));
  const auto rows = static_cast<Eigen::Index>(6 * sensors);
  return Eigen::MatrixXd(
      Eigen::Map<const Eigen::MatrixXd>(values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows));
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

Status AppendPlacedPoses(Store& store, const RevisionKey& key, const PlacedPoses& poses) {
  return store.connection().Append(Subject(key), [&]() -> Status {
    const Eigen::MatrixXd& motions = poses.motions;
    Query(store, "INSERT INTO revision_placed VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .Bind(key.robot, key.number, poses.reference, Joined(poses.sensors), BlobOfPoses(poses.T_ref_sensor),
              LowerOf(poses.covariance), BlobOf(motions.data(), static_cast<std::size_t>(motions.size())),
              BlobOf(poses.scale.data(), 6), poses.visible)
        .Run();
    return {};
  });
}

Result<std::optional<PlacedPoses>> LoadPlacedPoses(Store& store, const RevisionKey& key) {
  using Poses = std::optional<PlacedPoses>;
  return Load<Poses>(store, Subject(key), [&]() -> Result<Poses> {
    Query row(store,
              "SELECT reference, sensors, poses, lower, motions, scale, visible_ratio FROM revision_placed WHERE "
              "robot_id = ? "
              "AND revision_number = ?");
    if (!row.Bind(key.robot, key.number).Step()) return std::nullopt;
    PlacedPoses poses;
    poses.reference = row.IdAt<SensorId>(0);
    poses.sensors = Split(row.Text(1));
    RIGCAL_ASSIGN(poses.T_ref_sensor, PosesOf(key, row.Doubles(2), poses.sensors.size()));
    RIGCAL_ASSIGN(poses.covariance, WholeOf(row.Doubles(3), poses.sensors.size()));
    RIGCAL_ASSIGN(poses.motions, MotionsOf(key, row.Doubles(4), poses.sensors.size()));
    const std::vector<double> scale = row.Doubles(5);
    if (scale.size() != 6) return Fail(DamagedPoses(key));
    poses.scale = Eigen::Map<const Vector6d>(scale.data());
    poses.visible = row.Real(6);
    return poses;
  });
}

}  // namespace rigcal::storage
