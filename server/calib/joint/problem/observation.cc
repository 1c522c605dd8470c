#include "server/calib/joint/problem/observation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/calib/joint/problem/board_bend.h"

namespace rigcal::calib::joint {
namespace {

// Length of a corner's residual, in sigmas, beyond which it counts by its length only (Huber). Two normal numbers are
// beyond it once in 450 times.
constexpr double kCornerKnee = 3.5;

Se3 T_ref_board(const SessionState& state, const Where& where) {
  const Se3 T_ref_world = state.T_world_ref[static_cast<std::size_t>(where.place)].Inverse();
  return where.board == kNone ? T_ref_world : T_ref_world * state.T_world_board[static_cast<std::size_t>(where.board)];
}

// The own pose is that of the board in the sensor, T_sensor_board * Exp(own).
void AddPoseColumns(const Layout& layout, const SessionState& state, const Where& where, Eigen::Index own,
                    Observation& look) {
  const Matrix6d by_sensor = -Adjoint(T_sensor_board(state, where).Inverse());
  const auto add = [&](int at, const Matrix6d& by) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(own, 6);
    rows.topRows<6>() = by;
    look.columns.push_back({at, std::move(rows)});
  };
  add(layout.pose[static_cast<std::size_t>(where.sensor)], by_sensor);
  if (where.board != kNone && layout.board[static_cast<std::size_t>(where.board)] != kNone)
    add(layout.board[static_cast<std::size_t>(where.board)], Matrix6d::Identity());
  look.by_place = Eigen::MatrixXd::Zero(own, 6);
  look.by_place.topRows<6>() = -Adjoint(T_ref_board(state, where).Inverse());
}

void AddOwnColumn(int at, Eigen::Index own, Eigen::Index first, Eigen::Index count, Observation& look) {
  if (at == kNone) return;
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(own, count);
  by.middleRows(first, count).setIdentity();
  look.columns.push_back({at, std::move(by)});
}

// d(T Exp(xi) p) in the frame of T's right side.
Eigen::Matrix<double, 3, 6> MovedPoint(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> by;
  by << Eigen::Matrix3d::Identity(), -Hat(p);
  return by;
}

// Huber: weight of a residual and twice its cost.
struct Robust {
  double weight, cost;
};
Robust HuberOf(double norm) {
  if (norm <= kCornerKnee) return {1.0, norm * norm};
  return {kCornerKnee / norm, 2 * kCornerKnee * norm - kCornerKnee * kCornerKnee};
}

// Moments as a quadratic form of g = (n, b n, -d) for the board's plane (n, d) in the lidar, n towards the sensor. Of a
// range that is 2 s (1 + n . u) too short at the ray u, 2 s (n . u + (n . u)^2) more of distance, which is straight
// about the mean ray u_0 to the plate: (n . u)^2 ~ 2 m (n . u) - m^2 with m = n . u_0.
struct Plane {
  Vector7d g = Vector7d::Zero();
  Eigen::Matrix<double, 7, 8> by = Eigen::Matrix<double, 7, 8>::Zero();  // of [board pose, bias, slant bias]
};

Plane PlaneOf(const Se3& T_lidar_board, double range_bias_m, double slant_bias_m, const Eigen::Vector3d& mean_ray) {
  Plane plane;
  const Eigen::Matrix3d R = T_lidar_board.R();
  const Eigen::Vector3d n = -R.col(2), t = T_lidar_board.p_m;
  const double m = n.dot(mean_ray), by_ray = 2 + 4 * m;
  const double bias_m = range_bias_m + by_ray * slant_bias_m;
  plane.g << n, bias_m * n, -n.dot(t) - 2 * m * m * slant_bias_m;
  // R' = R (I + [w]x): n' = n - R (w x e_z) = n + R [e_z]x w;  t' = t + R v.
  const Eigen::Matrix3d dn = R * Hat(Eigen::Vector3d::UnitZ());
  plane.by.block<3, 3>(0, 3) = dn;
  plane.by.block<3, 3>(3, 3) = bias_m * dn;
  plane.by.block<1, 3>(6, 0) = -n.transpose() * R;
  plane.by.block<1, 3>(6, 3) = -t.transpose() * dn;
  plane.by.block<3, 1>(3, 6) = n;
  plane.by.col(7) << Eigen::Vector3d::Zero(), by_ray * n, -2 * m * m;
  return plane;
}

// One corner: J of the predicted pixel by the own unknowns, the residual in px, and the weight of its square.
struct CornerTerms {
  const Eigen::Vector2d& uv_px;
  const Eigen::Matrix<double, 2, Eigen::Dynamic>& J;
  Eigen::Vector2d r_px;
  double w;
};

Eigen::Vector2d HeldField(const Lens& lens, const SessionState& state, std::size_t camera,
                          const Eigen::Vector2d& uv_px) {
  const bool none = camera >= state.field_px.size() || state.field_px[camera].size() == 0;
  return none ? Eigen::Vector2d::Zero() : FieldAt(FieldGridOf(lens.picture), state.field_px[camera], uv_px);
}

// Of how far its entrance pupil lies towards what is seen at 45 degrees, the part at the angle of this point.
double PupilPart(const Eigen::Vector3d& p_cam) { return 2 * p_cam.head<2>().squaredNorm() / p_cam.squaredNorm(); }

// Behind the pose and the refined intrinsics: which of a look's other numbers are unknowns, and where.
struct OwnColumns {
  bool scales, bends, strains, shifts;
  Eigen::Index scale_at, bend_at, strain_at, shift_at, size;
};
OwnColumns OwnColumnsOf(const Layout& layout, std::size_t camera, std::size_t target, Eigen::Index refined) {
  OwnColumns own{layout.scale[target] != kNone,
                 layout.bend[target] != kNone,
                 layout.strain[target] != kNone,
                 layout.pupil[camera] != kNone,
                 6 + refined,
                 0,
                 0,
                 0,
                 0};
  own.bend_at = own.scale_at + (own.scales ? 1 : 0);
  own.strain_at = own.bend_at + (own.bends ? 3 : 0);
  own.shift_at = own.strain_at + (own.strains ? 3 : 0);
  own.size = own.shift_at + (own.shifts ? 1 : 0);
  return own;
}

// At a pose of the board in the camera. `visit` sees each corner. Nothing where one cannot be seen by the camera.
template <typename Visit>
std::optional<Observation> CornersAt(const Se3& T_cam_board, const SessionProblem& problem, const Layout& layout,
                                     const SessionState& state, const CornersSeen& seen, const SensorNoise& noise,
                                     double weight, const Visit& visit) {
  const auto camera = static_cast<std::size_t>(seen.camera), target = static_cast<std::size_t>(seen.target);
  const Lens& lens = problem.cameras[camera];
  const auto refined = static_cast<Eigen::Index>(lens.refined.size());
  const auto [scales, bends, strains, shifts, scale_at, bend_at, strain_at, shift_at, own] =
      OwnColumnsOf(layout, camera, target, refined);
  const Eigen::Vector3d middle = PlateCentreOf(problem.targets[target]);
  const Eigen::Matrix3d R = T_cam_board.R();
  Observation look;
  Eigen::Matrix<double, 2, Eigen::Dynamic> J(2, own);
  Eigen::MatrixXd weighted(own, 2 * static_cast<Eigen::Index>(seen.corners.size()));  // J^T, weighted
  Eigen::VectorXd weighted_r(weighted.cols());
  for (std::size_t i = 0; i < seen.corners.size(); ++i) {
    const Eigen::Vector2d& uv_px = seen.corners.uv_px[i];
    const auto idx = static_cast<std::size_t>(seen.corners.idx[i]);
    const Eigen::Vector3d& p_flat = problem.target_points[target][idx];
    const Eigen::Vector3d& bend = problem.target_bend_shapes[target][idx];
    const Eigen::Matrix3d strain = StrainShape(p_flat - middle);
    Eigen::Vector3d p_board =
        (1 + state.board_scale_ratio[target]) * p_flat + strain * state.print_strain_ratio[target];
    p_board.z() += state.board_bend_m[target].dot(bend);
    Eigen::Vector3d p_cam = T_cam_board * p_board;
    const double pupil_part = PupilPart(p_cam);  // held in the derivatives
    p_cam.z() -= pupil_part * state.pupil_shift_m[camera];
    const Projection projected = Project(lens.model, state.intrinsics[camera], p_cam);
    if (!projected.in_front) return std::nullopt;
    const PointJacobian by_point = projected.d_point * R;
    J.leftCols<6>() = by_point * MovedPoint(p_board);
    for (Eigen::Index k = 0; k < refined; ++k)
      J.col(6 + k) = projected.d_intrinsics.col(lens.refined[static_cast<std::size_t>(k)]);
    if (scales) J.col(scale_at) = by_point * p_flat;
    if (bends) J.middleCols<3>(bend_at) = by_point.col(2) * bend.transpose();
    if (strains) J.middleCols<3>(strain_at) = by_point * strain;
    if (shifts) J.col(shift_at) = -pupil_part * projected.d_point.col(2);
    const Eigen::Vector2d r_px = projected.uv_px + HeldField(lens, state, camera, uv_px) - uv_px;
    const Eigen::Vector2d r = r_px / noise.sigma;
    const Robust robust = HuberOf(r.norm());
    const double w = weight * robust.weight;
    weighted.middleCols<2>(2 * static_cast<Eigen::Index>(i)) = std::sqrt(w) / noise.sigma * J.transpose();
    weighted_r.segment<2>(2 * static_cast<Eigen::Index>(i)) = std::sqrt(w) * r;
    look.cost += weight * robust.cost;
    look.squares += robust.weight * r.squaredNorm();
    look.numbers += 2 * robust.weight;
    visit(CornerTerms{uv_px, J, r_px, w / (noise.sigma * noise.sigma)});
  }
  look.A = Eigen::MatrixXd::Zero(own, own);
  look.A.selfadjointView<Eigen::Lower>().rankUpdate(weighted);
  look.A.triangularView<Eigen::StrictlyUpper>() = look.A.transpose();
  look.b = weighted * weighted_r;
  AddPoseColumns(layout, state, seen, own, look);
  AddOwnColumn(layout.lens[camera], own, 6, refined, look);
  AddOwnColumn(layout.scale[target], own, scale_at, 1, look);
  AddOwnColumn(layout.bend[target], own, bend_at, 3, look);
  AddOwnColumn(layout.strain[target], own, strain_at, 3, look);
  AddOwnColumn(layout.pupil[camera], own, shift_at, 1, look);
  return look;
}

// The camera moved by xi sees the board at Exp(-xi) T_cam_board. As an angle sigma_rad moves a board alike whether the
// camera turns or shifts.
LookError ErrorOf(const Observation& look, const Se3& T_cam_board, const Vector6d& xi, const Vector6d& information) {
  LookError error;
  error.xi = xi, error.information = information;
  error.by_pose = -Adjoint(T_cam_board.Inverse());
  Matrix6d H = error.by_pose.transpose() * look.A.topLeftCorner<6, 6>() * error.by_pose;
  H.diagonal() += information;
  error.K = H.inverse();
  error.b = error.by_pose.transpose() * look.b.head<6>() + information.cwiseProduct(xi);
  error.squares = xi.dot(information.cwiseProduct(xi));
  error.log_det = -std::log(error.K.determinant()) - information.array().log().sum();
  error.held = error.K.diagonal().dot(information);
  error.by_own = error.K * error.by_pose.transpose() * look.A.topRows<6>();
  return error;
}

void Eliminate(LookError error, double weight, Observation& look) {
  const Eigen::MatrixXd cross = look.A.leftCols<6>() * error.by_pose;
  look.A = weight * (look.A - cross * error.by_own);
  look.b = weight * (look.b - cross * (error.K * error.b));
  look.cost = weight * (look.cost + error.squares);
  look.error = std::move(error);
}

// Gauss-Newton for the error alone, which is small.
template <typename Visit>
std::optional<Observation> CornersWithError(const Se3& T_cam_board, const SessionProblem& problem, const Layout& layout,
                                            const SessionState& state, const CornersSeen& seen,
                                            const SensorNoise& noise, double weight, const Visit& visit) {
  constexpr int kSteps = 4;
  const double sigma_m = noise.sigma_rad * T_cam_board.p_m.norm();
  const Vector6d information = EachAxis(std::pow(sigma_m, -2), std::pow(noise.sigma_rad, -2));
  Vector6d xi = Vector6d::Zero();
  for (int step = 0; step < kSteps; ++step) {
    const Se3 T = Se3::Exp(-xi) * T_cam_board;
    const auto look = CornersAt(T, problem, layout, state, seen, noise, 1.0, [](const CornerTerms&) {});
    if (!look) return std::nullopt;
    const LookError error = ErrorOf(*look, T, xi, information);
    xi -= error.K * error.b;
  }
  const Se3 T = Se3::Exp(-xi) * T_cam_board;
  auto look = CornersAt(T, problem, layout, state, seen, noise, 1.0, visit);
  if (look) Eliminate(ErrorOf(*look, T, xi, information), weight, *look);
  return look;
}

template <typename Visit>
std::optional<Observation> ObserveCorners(const SessionProblem& problem, const Layout& layout,
                                          const SessionState& state, const CornersSeen& seen, const SensorNoise& noise,
                                          double weight, const Visit& visit) {
  const Se3 T_cam_board = T_sensor_board(state, seen);
  return noise.sigma_rad > 0 ? CornersWithError(T_cam_board, problem, layout, state, seen, noise, weight, visit)
                             : CornersAt(T_cam_board, problem, layout, state, seen, noise, weight, visit);
}

// As Eliminate, of the field's terms, which are still those of a look of weight 1.
void EliminateFromField(const LookError& error, double weight, FieldLook& look) {
  const Eigen::MatrixXd of_field = error.by_pose.transpose() * look.own_field.topRows<6>();
  look.own_field = weight * (look.own_field - error.by_own.transpose() * of_field);
  look.b = weight * (look.b - of_field.transpose() * (error.K * error.b));
  look.by_points *= weight;
  look.by_error = error.K.llt().matrixU() * (std::sqrt(weight) * of_field);
}

// The columns of the control points that reach a pixel, and their weights; a point that is left out reaches almost
// none.
void AddFieldTerms(const FieldWeights& field, const std::vector<int>& seen_points, const CornerTerms& corner,
                   FieldLook& look) {
  std::array<Eigen::Index, 9> column{};
  for (std::size_t i = 0; i < column.size(); ++i) {
    const auto at = std::lower_bound(seen_points.begin(), seen_points.end(), field.point[i]);
    column[i] = at != seen_points.end() && *at == field.point[i] ? at - seen_points.begin() : kNone;
  }
  const auto points = static_cast<Eigen::Index>(seen_points.size());
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (column[i] == kNone) continue;
    const double w = corner.w * field.weight[i];
    const Eigen::Index u = column[i], v = points + u;
    look.own_field.col(u) += w * corner.J.row(0).transpose();
    look.own_field.col(v) += w * corner.J.row(1).transpose();
    look.b[u] += w * corner.r_px[0];
    look.b[v] += w * corner.r_px[1];
    for (std::size_t j = 0; j < column.size(); ++j)
      if (column[j] != kNone) look.by_points(u, column[j]) += w * field.weight[j];
  }
}

}  // namespace

Se3 T_world_body(const SessionState& state, const PoseTold& told) {
  const Se3 T_other_body =
      told.clock == kNone
          ? told.T_world_body
          : told.T_world_body * told.path.StepTo(state.clock_late_s[static_cast<std::size_t>(told.clock)]);
  return told.board == kNone ? T_other_body : state.T_world_board[static_cast<std::size_t>(told.board)] * T_other_body;
}

Se3 T_sensor_board(const SessionState& state, const Where& where) {
  return state.T_ref_sensor[static_cast<std::size_t>(where.sensor)].Inverse() * T_ref_board(state, where);
}

std::optional<Observation> Observe(const SessionProblem& problem, const Layout& layout, const SessionState& state,
                                   const CornersSeen& seen, const SensorNoise& noise, double weight) {
  return ObserveCorners(problem, layout, state, seen, noise, weight, [](const CornerTerms&) {});
}

std::optional<FieldLook> ObserveWithField(const SessionProblem& problem, const Layout& layout,
                                          const SessionState& state, const CornersSeen& seen, const SensorNoise& noise,
                                          double weight, const std::vector<int>& seen_points) {
  const FieldGrid grid = FieldGridOf(problem.cameras[static_cast<std::size_t>(seen.camera)].picture);
  const auto points = static_cast<Eigen::Index>(seen_points.size());
  FieldLook look;
  look.by_points = Eigen::MatrixXd::Zero(points, points);
  look.b = Eigen::VectorXd::Zero(2 * points);
  auto plain = ObserveCorners(problem, layout, state, seen, noise, weight, [&](const CornerTerms& corner) {
    if (look.own_field.size() == 0) look.own_field = Eigen::MatrixXd::Zero(corner.J.cols(), 2 * points);
    AddFieldTerms(FieldWeightsAt(grid, corner.uv_px), seen_points, corner, look);
  });
  if (!plain) return std::nullopt;
  look.plain = std::move(*plain);
  if (look.plain.error) EliminateFromField(*look.plain.error, weight, look);
  return look;
}

std::vector<Eigen::Vector2d> CornerResiduals(const SessionProblem& problem, const SessionState& state,
                                             const CornersSeen& seen, const SensorNoise& noise) {
  std::vector<Eigen::Vector2d> residuals_px;
  (void)ObserveCorners(problem, LayoutOf(problem), state, seen, noise, 1.0,
                       [&](const CornerTerms& corner) { residuals_px.push_back(corner.r_px); });
  return residuals_px;
}

Observation Observe(const SessionProblem&, const Layout& layout, const SessionState& state, const PlateSeen& seen,
                    const SensorNoise& noise, double weight) {
  const auto lidar = static_cast<std::size_t>(seen.sensor);
  const bool biased = layout.bias[lidar] != kNone, slanted = layout.slant[lidar] != kNone;
  const Eigen::Index own = 6 + (biased ? 1 : 0) + (slanted ? 1 : 0);
  const Eigen::Vector3d mean_ray = seen.moments.sum.block<3, 1>(3, 6).normalized();
  const Plane plane =
      PlaneOf(T_sensor_board(state, seen), state.range_bias_m[lidar], state.slant_bias_m[lidar], mean_ray);
  Eigen::MatrixXd by = plane.by.leftCols<6>();
  by.conservativeResize(Eigen::NoChange, own);
  if (biased) by.col(6) = plane.by.col(6);
  if (slanted) by.col(own - 1) = plane.by.col(7);
  const double scale = 1 / (noise.sigma * noise.sigma);
  Observation look;
  look.A = weight * scale * by.transpose() * seen.moments.sum * by;
  look.b = weight * scale * by.transpose() * (seen.moments.sum * plane.g);
  look.squares = scale * plane.g.dot(seen.moments.sum * plane.g);
  look.cost = weight * look.squares;
  look.numbers = 3.0;
  AddPoseColumns(layout, state, seen, own, look);
  if (biased) AddOwnColumn(layout.bias[lidar], own, 6, 1, look);
  if (slanted) AddOwnColumn(layout.slant[lidar], own, own - 1, 1, look);
  return look;
}

Observation Observe(const SessionProblem&, const Layout& layout, const SessionState& state, const PoseTold& told,
                    const SensorNoise& noise, double weight) {
  const auto sensor = static_cast<std::size_t>(told.sensor), place = static_cast<std::size_t>(told.place);
  const Se3& T_ref_body = state.T_ref_sensor[sensor];
  const Vector6d e = (T_world_body(state, told).Inverse() * state.T_world_ref[place] * T_ref_body).Log();
  const Matrix6d J = RightJacobianInverse(e);
  const Vector6d information = EachAxis(std::pow(noise.sigma, -2), std::pow(noise.sigma_rad, -2));
  Observation look;
  look.A = weight * J.transpose() * information.asDiagonal() * J;
  look.b = weight * J.transpose() * information.asDiagonal() * e;
  look.squares = e.dot(information.asDiagonal() * e);
  look.cost = weight * look.squares;
  look.numbers = 6.0;
  look.squares_of_pose << e.head<3>().squaredNorm() * information[0], e.tail<3>().squaredNorm() * information[3];
  look.columns.push_back({layout.pose[sensor], Matrix6d::Identity()});
  if (told.board != kNone)
    look.columns.push_back({layout.board[static_cast<std::size_t>(told.board)], -Adjoint(T_sensor_board(state, told))});
  if (const int at = told.clock == kNone ? kNone : layout.clock[static_cast<std::size_t>(told.clock)]; at != kNone) {
    // Later by h the told pose is T_told Exp(h w): e follows as if the body went back by Ad(Exp(-e)) h w.
    const double late_s = state.clock_late_s[static_cast<std::size_t>(told.clock)];
    look.columns.push_back({at, -Adjoint(Se3::Exp(-e)) * told.path.TwistAt(late_s)});
  }
  look.by_place = Adjoint(T_ref_body.Inverse());
  return look;
}

Observation Observe(const Layout& layout, const SessionState& state, const RelativeKnown& known) {
  const Se3 T_a_b = state.T_ref_sensor[static_cast<std::size_t>(known.sensor_a)].Inverse() *
                    state.T_ref_sensor[static_cast<std::size_t>(known.sensor_b)];
  const Vector6d e = (known.T_a_b.Inverse() * T_a_b).Log();
  const Matrix6d J = RightJacobianInverse(e);
  Observation look;
  look.A = J.transpose() * known.Omega * J;
  look.b = J.transpose() * known.Omega * e;
  look.squares = look.cost = e.dot(known.Omega * e);
  look.numbers = 6.0;
  look.columns.push_back({layout.pose[static_cast<std::size_t>(known.sensor_a)], -Adjoint(T_a_b.Inverse())});
  look.columns.push_back({layout.pose[static_cast<std::size_t>(known.sensor_b)], Matrix6d::Identity()});
  return look;
}

}  // namespace rigcal::calib::joint
