#include "storage/fleet/visit_scatter.h"

#include <algorithm>
#include <cmath>

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string ScatterSubject(const RobotId& robot) { return "what visits of robot " + robot.str() + " scatter by"; }

bool IsNumber(const ScatterOfAxes& scatter) {
  return std::isfinite(scatter.between) && std::isfinite(scatter.own) && std::isfinite(scatter.dof) &&
         std::all_of(scatter.ratio.begin(), scatter.ratio.end(), [](double of_axis) { return std::isfinite(of_axis); });
}

bool IsKept(const VisitScatter& scatter) { return scatter.translation.dof > 0 && scatter.rotation.dof > 0; }

ScatterOfAxes ScatterAt(const Query& query, int first, int ratio) {
  return {query.Real(first),
          query.Real(first + 1),
          query.Real(first + 2),
          {query.Real(ratio), query.Real(ratio + 1), query.Real(ratio + 2)}};
}

}  // namespace

Status ReplaceVisitScatter(Store& store, const RobotId& robot, const std::string& rig_model, const SensorId& reference,
                           const std::map<SensorId, VisitScatter>& scatter) {
  return store.connection().Append(ScatterSubject(robot), [&]() -> Status {
    Query(store, "DELETE FROM summary_scatter WHERE robot_id = ?").Bind(robot).Run();
    if (rig_model.empty()) return {};
    for (const auto& [sensor, one] : scatter) {
      if (!IsKept(one)) continue;
      if (!IsNumber(one.translation) || !IsNumber(one.rotation))
        return Fail(ErrorCode::kInvalidInput,
                    ScatterSubject(robot) + ": " + sensor.str() + " has a number that is none",
                    "Report this as an error of Rigcal.");
      const ThreeAxes &shifts = one.translation.ratio, &turns = one.rotation.ratio;
      Query(store, "INSERT INTO summary_scatter VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
          .Bind(rig_model, reference, robot, sensor, one.translation.between, one.translation.own, one.translation.dof,
                one.rotation.between, one.rotation.own, one.rotation.dof, shifts[0], shifts[1], shifts[2], turns[0],
                turns[1], turns[2])
          .Run();
    }
    return {};
  });
}

Result<std::vector<std::map<SensorId, VisitScatter>>> LoadScatterOfOthers(Store& store, const RobotId& robot,
                                                                          const std::string& rig_model,
                                                                          const SensorId& reference, int robots_max) {
  using Robots = std::vector<std::map<SensorId, VisitScatter>>;
  return Load<Robots>(store, "what robots of rig model " + rig_model + " scatter by", [&]() -> Result<Robots> {
    Query query(store,
                "SELECT robot_id, sensor_id, translation_between_m2, translation_own_m2, translation_dof, "
                "rotation_between_rad2, "
                "rotation_own_rad2, rotation_dof, translation_x_ratio, translation_y_ratio, translation_z_ratio, "
                "rotation_x_ratio, "
                "rotation_y_ratio, rotation_z_ratio FROM summary_scatter WHERE rig_model = ? AND reference_id = ? AND "
                "robot_id <> ? "
                "ORDER BY robot_id, sensor_id");
    query.Bind(rig_model, reference, robot);
    Robots robots;
    std::string last;  // no robot is called so
    while (query.Step()) {
      if (query.Text(0) != last && robots.size() == static_cast<std::size_t>(std::max(0, robots_max))) break;
      if (query.Text(0) != last) robots.emplace_back();
      last = query.Text(0);
      robots.back()[query.IdAt<SensorId>(1)] = {ScatterAt(query, 2, 8), ScatterAt(query, 5, 11)};
    }
    return robots;
  });
}

}  // namespace rigcal::storage
