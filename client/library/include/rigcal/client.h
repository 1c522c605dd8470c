// Rigcal for C++20: push a session or edges, ask, and follow the calibration that a robot is to use. All of it is in
// this header; what it calls is the C interface of librigcal (c_api.h), so that library and program need not be built
// by one compiler.
//
//   rigcal::Client client;
//   rigcal::Lookup found = client.LookUp("mapper-01", "front_left", "lidar");
//   if (found.T_a_b) Use(found.T_a_b->pose.Matrix(), found.T_a_b->covariance);
//
// Poses: p_a = T_a_b * p_b, the pose of b in a; metres and radians; q_xyzw Hamilton. Covariances have the order [x y z
// rx ry rz] and belong to T * Exp(xi), in the axes of b. What cannot be done is thrown as rigcal::Error, whose sentence
// names what is wrong and its cure. A Client and its Followers are used by one thread at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "c_api.h"

namespace rigcal {

using Matrix4 = std::array<std::array<double, 4>, 4>;
using Matrix6 = std::array<std::array<double, 6>, 6>;

enum class Code { kInvalidInput = 1, kNotFound, kConflict, kBusy, kUnreachable, kUnsupported, kStorage, kInternal };

class Error : public std::runtime_error {
 public:
  Error(Code code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
  // What kind of fault it is: kUnreachable may pass by itself.
  [[nodiscard]] Code code() const { return code_; }

 private:
  Code code_;
};

namespace detail {

inline void CheckRigid(const Matrix4& T) {
  constexpr double kTolerance = 1e-3;  // of numbers that somebody copied
  const auto refuse = [](const std::string& what) {
    throw Error(Code::kInvalidInput,
                "a 4 x 4 matrix is no pose: " + what + ". Give [R p; 0 1] with R a rotation and p in metres.");
  };
  for (const auto& row : T)
    for (const double value : row)
      if (!std::isfinite(value)) refuse("a number is not finite");
  if (T[3] != std::array<double, 4>{0.0, 0.0, 0.0, 1.0}) refuse("its last row is not 0 0 0 1");
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double product = T[i][0] * T[j][0] + T[i][1] * T[j][1] + T[i][2] * T[j][2];
      if (std::abs(product - (i == j ? 1.0 : 0.0)) > kTolerance)
        refuse("its rows are not at right angles and of length 1");
    }
  const double z_x = T[0][1] * T[1][2] - T[0][2] * T[1][1], z_y = T[0][2] * T[1][0] - T[0][0] * T[1][2],
               z_z = T[0][0] * T[1][1] - T[0][1] * T[1][0];
  if (z_x * T[2][0] + z_y * T[2][1] + z_z * T[2][2] < 0.0) refuse("it mirrors");
}

}  // namespace detail

struct Pose {
  std::array<double, 3> p_m{};
  std::array<double, 4> q_xyzw{0.0, 0.0, 0.0, 1.0};
  // [R p; 0 1].
  [[nodiscard]] Matrix4 Matrix() const {
    const auto [x, y, z, w] = q_xyzw;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), p_m[0]},
             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), p_m[1]},
             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), p_m[2]},
             {0.0, 0.0, 0.0, 1.0}}};
  }
};

// Of [R p; 0 1], where R is a rotation; q_xyzw by its largest component (Shepperd 1978), w >= 0. kInvalidInput where R
// is none to 1e-3 (mirrored, scaled, transposed into another row), the last row is another, or a number is not finite.
[[nodiscard]] inline Pose PoseOf(const Matrix4& T) {
  detail::CheckRigid(T);
  const std::array<double, 4> squares = {1 + T[0][0] - T[1][1] - T[2][2], 1 - T[0][0] + T[1][1] - T[2][2],
                                         1 - T[0][0] - T[1][1] + T[2][2],
                                         1 + T[0][0] + T[1][1] + T[2][2]};  // 4 times those of x y z w
  const double yz = T[2][1] - T[1][2], zx = T[0][2] - T[2][0], xy = T[1][0] - T[0][1];
  const double sum_xy = T[0][1] + T[1][0], sum_zx = T[0][2] + T[2][0], sum_yz = T[1][2] + T[2][1];
  const std::array<std::array<double, 4>, 4> rows = {{{squares[0], sum_xy, sum_zx, yz},
                                                      {sum_xy, squares[1], sum_yz, zx},
                                                      {sum_zx, sum_yz, squares[2], xy},
                                                      {yz, zx, xy, squares[3]}}};
  std::size_t largest = 3;
  for (std::size_t i = 0; i < 3; ++i)
    if (squares[i] > squares[largest]) largest = i;
  Pose pose{{T[0][3], T[1][3], T[2][3]}, rows[largest]};
  double length = 0.0;
  for (const double part : pose.q_xyzw) length = std::hypot(length, part);
  if (pose.q_xyzw[3] < 0) length = -length;
  for (double& part : pose.q_xyzw) part /= length;
  return pose;
}

struct MeasuredPose {
  Pose pose;
  Matrix6 covariance{};
};

// What a revision is worth: "pass", "warn", "fail" or "unknown", and whether the robot may drive by it, in words.
// `revision` 0: none.
struct Standing {
  std::int64_t revision = 0;
  std::string verdict, drive_rule;
};

struct Lookup {
  std::optional<MeasuredPose> T_a_b;  // nothing where a direction of it was not measured
  Standing standing;
};

// A pairwise result of another tool. Of `covariance` and `information` the one that is known; the second may be
// singular.
struct Edge {
  std::string frame_a, frame_b;
  Pose T_a_b;
  std::optional<Matrix6> covariance = {}, information = {};
  int dof = 0;  // behind the uncertainty, such as captures - 1; 0: known exactly
  std::string method = "given";
  std::string measured_at = {};  // ISO 8601; empty: not told
};

struct PushOptions {
  bool wait = true;            // for the result; else until all is on the server's disk
  bool new_robot = false;      // the name is right, though it is one slip away from a known robot's
  double give_up_s = 60.0;     // without any answer
  std::string remounted = {};  // of a session: sensors that were moved on purpose, with commas between
};

struct PushResult {
  std::string id;  // of the session or batch
  std::int64_t items = 0, total = 0,
               held_before = 0;  // files or edges; bytes or edges, and how many of them were there before
  Standing standing;             // of the revision that holds them
  std::string remarks;           // for people: what was stored, and what looks odd in it
};

struct SensorPose {
  std::string sensor;
  std::optional<MeasuredPose> T_ref_sensor;  // nothing where a direction of it was not measured
};

// `revision` 0: none is in use, and the robot is not to go by any.
struct Calibration {
  std::int64_t revision = 0;
  std::string digest, reference;
  std::vector<SensorPose> sensors;
};

struct Options {
  int domain = 0;          // of DDS; RIGCAL_DOMAIN overrules it
  std::string tag = {};    // of discovery; empty: RIGCAL_DDS_TAG
  double timeout_s = 5.0;  // of a question
};

namespace detail {

inline void Check(int code, const rigcal_client* client) {
  if (code != RIGCAL_GOOD) throw Error(static_cast<Code>(code), rigcal_error(client));
}

template <typename Matrix, std::size_t kCount>
void Unfold(const double (&from)[kCount], Matrix& to) {
  for (std::size_t i = 0; i < kCount; ++i) to[i / to.size()][i % to.size()] = from[i];
}

template <std::size_t kCount>
void Fold(const Matrix6& from, double (&to)[kCount]) {
  for (std::size_t i = 0; i < kCount; ++i) to[i] = from[i / 6][i % 6];
}

inline std::optional<MeasuredPose> PoseOf(const rigcal_pose& from) {
  if (from.known == 0) return std::nullopt;
  MeasuredPose to{{std::to_array(from.p_m), std::to_array(from.q_xyzw)}, {}};
  Unfold(from.covariance, to.covariance);
  return to;
}

inline Standing StandingOf(const rigcal_standing& from) { return {from.revision, from.verdict, from.drive_rule}; }

inline rigcal_edge EdgeOf(const Edge& edge) {
  rigcal_edge to{};
  to.frame_a = edge.frame_a.c_str();
  to.frame_b = edge.frame_b.c_str();
  std::copy(edge.T_a_b.p_m.begin(), edge.T_a_b.p_m.end(), to.p_m);
  std::copy(edge.T_a_b.q_xyzw.begin(), edge.T_a_b.q_xyzw.end(), to.q_xyzw);
  if (edge.covariance) Fold(*edge.covariance, to.covariance);
  if (edge.information) Fold(*edge.information, to.information);
  to.dof = edge.dof;
  to.method = edge.method.c_str();
  to.measured_at = edge.measured_at.empty() ? nullptr : edge.measured_at.c_str();
  return to;
}

}  // namespace detail

// Follows the calibration of one robot; the Client outlives it.
class Follower {
 public:
  // At first what is in use now, then each change of it; nothing where none came within the time. After an Error what
  // was told last still holds: call again.
  [[nodiscard]] std::optional<Calibration> Next(double timeout_s) {
    rigcal_calibration told{};
    int news = 0;
    detail::Check(rigcal_next(follower_.get(), timeout_s, &told, &news), client_);
    if (news == 0) return std::nullopt;
    Calibration calibration{told.revision, told.digest, told.reference, {}};
    for (const rigcal_sensor& row : std::span(told.sensors, told.sensor_count))
      calibration.sensors.push_back({row.sensor, detail::PoseOf(row.T_ref_sensor)});
    return calibration;
  }

 private:
  friend class Client;
  Follower(rigcal_client* client, const std::string& robot)
      : client_(client), follower_(rigcal_follow(client, robot.c_str()), &rigcal_unfollow) {
    if (!follower_) throw Error(Code::kInvalidInput, rigcal_error(client));
  }

  rigcal_client* client_;
  std::unique_ptr<rigcal_follower, void (*)(rigcal_follower*)> follower_;
};

class Client {
 public:
  // Does not wait for a server; where DDS does not start, the first call says so.
  explicit Client(const Options& options = {}) : client_(Open(options), &rigcal_close) {}

  // A question or order of docs/api.md and the parameters, as JSON; the document that answers it.
  std::string Ask(const std::string& verb, const std::string& json = "{}") {
    Check(rigcal_ask(client_.get(), verb.c_str(), json.c_str()));
    return Document();
  }
  // The pose of sensor b in sensor a, of a numbered revision or of the one that is in use (0); kConflict where none is.
  [[nodiscard]] Lookup LookUp(const std::string& robot, const std::string& a, const std::string& b,
                              std::int64_t revision = 0) {
    rigcal_pose pose{};
    rigcal_standing standing{};
    Check(rigcal_lookup(client_.get(), robot.c_str(), a.c_str(), b.c_str(), revision, &pose, &standing));
    return {detail::PoseOf(pose), detail::StandingOf(standing)};
  }
  // A folder of docs/session-format.md. Broken off, the same call goes on where it was; again it changes nothing.
  PushResult PushSession(const std::string& folder, const PushOptions& options = {}) {
    return Push(options, [&](const rigcal_push_options* wishes, rigcal_push_result* result) {
      return rigcal_push_session(client_.get(), folder.c_str(), wishes, result);
    });
  }
  // Finished edges, in one batch; likewise.
  PushResult PushEdges(const std::string& robot, std::span<const Edge> edges, const PushOptions& options = {}) {
    std::vector<rigcal_edge> rows;
    for (const Edge& edge : edges) rows.push_back(detail::EdgeOf(edge));
    return Push(options, [&](const rigcal_push_options* wishes, rigcal_push_result* result) {
      return rigcal_push_edges(client_.get(), robot.c_str(), rows.data(), rows.size(), wishes, result);
    });
  }
  // The calibration that the robot is to use, and what becomes of it.
  [[nodiscard]] Follower Follow(const std::string& robot) { return {client_.get(), robot}; }
  // The whole JSON document behind the last call that was good.
  [[nodiscard]] std::string Document() const { return rigcal_text(client_.get()); }

 private:
  static rigcal_client* Open(const Options& options) {
    const rigcal_options wishes{options.domain, options.tag.c_str(), options.timeout_s};
    return rigcal_open(&wishes);
  }
  void Check(int code) const { detail::Check(code, client_.get()); }
  template <typename Call>
  PushResult Push(const PushOptions& options, const Call& call) {
    const rigcal_push_options wishes{options.wait ? 0 : 1, options.new_robot ? 1 : 0, options.give_up_s,
                                     options.remounted.c_str()};
    rigcal_push_result told{};
    Check(call(&wishes, &told));
    return {told.id, told.items, told.total, told.held_before, detail::StandingOf(told.standing), told.remarks};
  }

  std::unique_ptr<rigcal_client, void (*)(rigcal_client*)> client_;
};

}  // namespace rigcal
