#include "client/moments/clock_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "client/moments/pose_curve.h"

namespace rigcal::moments {
namespace {

constexpr int kUnknowns = 8;  // the pose between the two, offset, drift
constexpr int kBlocks = 10, kIterations = 12;
constexpr std::size_t kPosesMin = 60;
constexpr double kLagStep_s = 0.005, kCorrelationMin = 0.5, kTimeStep_s = 0.002, kHuber_sigmas = 2.0;
constexpr double kMovedMin_m_s = 0.05, kMovedMin_rad_s = 0.1;  // root mean square over the track: less tells no time
constexpr double kSigmaMin_s = 2e-5;
constexpr double kOfFewBlocks =
    1.36;  // three sigmas of so few blocks are to be as rare as of many: Student's t of 9, 4.09
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// Of two series side by side: how alike they rise and fall, 1 at most.
class Correlation {
 public:
  void Add(double x, double y) { n_ += 1, x_ += x, y_ += y, xx_ += x * x, yy_ += y * y, xy_ += x * y; }
  [[nodiscard]] double Value() const {
    const double spread = (xx_ - x_ * x_ / n_) * (yy_ - y_ * y_ / n_);
    return n_ >= static_cast<double>(kPosesMin) / 2 && spread > 0 ? (xy_ - x_ * y_ / n_) / std::sqrt(spread) : -1.0;
  }

 private:
  double n_ = 0, x_ = 0, y_ = 0, xx_ = 0, yy_ = 0, xy_ = 0;
};

bool Moves(const std::vector<TimedSpeed>& speeds) {
  double m2_s2 = 0, rad2_s2 = 0;
  for (const TimedSpeed& speed : speeds) m2_s2 += speed.m_s * speed.m_s, rad2_s2 += speed.rad_s * speed.rad_s;
  const auto n = static_cast<double>(speeds.size());
  return m2_s2 >= n * kMovedMin_m_s * kMovedMin_m_s || rad2_s2 >= n * kMovedMin_rad_s * kMovedMin_rad_s;
}

// The lag at which the motions of both are most alike.
std::optional<double> CoarseOffset_s(const std::vector<TimedSpeed>& reference, const std::vector<TimedSpeed>& sensor) {
  double best = 2 * kCorrelationMin;
  std::optional<double> offset_s;
  for (double lag_s = -kClockOff_sMax; lag_s <= kClockOff_sMax; lag_s += kLagStep_s) {
    Correlation shift, turn;
    for (const TimedSpeed& speed : sensor)
      if (const auto there = SpeedAt(reference, speed.t_s - lag_s)) {
        shift.Add(there->m_s, speed.m_s);
        turn.Add(there->rad_s, speed.rad_s);
      }
    const double alike = shift.Value() + turn.Value();
    if (alike > best) best = alike, offset_s = lag_s;
  }
  return offset_s;
}

// One pose of the sensor against the reference's curve: where the board's middle is and how it is turned, in the
// sensor's frame, and how that follows the unknowns.
struct Row {
  Vector6d residual;
  Eigen::Matrix<double, 6, kUnknowns> J;
  std::size_t block = 0;
};

class Fitter {
 public:
  Fitter(const std::vector<TimedPose>& reference, const std::vector<TimedPose>& sensor, const Eigen::Vector3d& centre_m)
      : reference_(reference), sensor_(sensor), centre_m_(centre_m) {
    fit_.at_s = (sensor.front().t_s + sensor.back().t_s) / 2;
  }

  std::optional<ClockFit> Fit(double offset_s) {
    fit_.offset_s = offset_s;
    if (!StartBetween()) return std::nullopt;
    for (int i = 0; i < kIterations; ++i)
      if (!Step()) return std::nullopt;
    Jackknife();
    return fit_;
  }

 private:
  // Of the sensor's clock on the reference's.
  [[nodiscard]] std::optional<Se3> ReferenceAt(double t_s) const {
    return PoseAt(reference_, t_s - fit_.OffsetAt_s(t_s));
  }

  // Of the poses between, one after the other, that which is nearest to the others' middle.
  bool StartBetween() {
    std::vector<Se3> between;
    for (const TimedPose& pose : sensor_)
      if (const auto there = ReferenceAt(pose.t_s)) between.push_back(pose.T_cam_board * there->Inverse());
    if (between.size() < kPosesMin) return false;
    std::array<std::vector<double>, 3> places;
    for (const Se3& T : between)
      for (int k = 0; k < 3; ++k) places[static_cast<std::size_t>(k)].push_back(T.p_m[k]);
    Eigen::Vector3d middle;
    for (std::size_t k = 0; k < 3; ++k) {
      std::nth_element(places[k].begin(), places[k].begin() + static_cast<std::ptrdiff_t>(places[k].size() / 2),
                       places[k].end());
      middle[static_cast<Eigen::Index>(k)] = places[k][places[k].size() / 2];
    }
    T_sensor_reference_ = *std::min_element(between.begin(), between.end(), [&](const Se3& a, const Se3& b) {
      return (a.p_m - middle).squaredNorm() < (b.p_m - middle).squaredNorm();
    });
    return true;
  }

  [[nodiscard]] std::optional<Row> RowOf(std::size_t j) const {
    const double t_s = sensor_[j].t_s, on_reference_s = t_s - fit_.OffsetAt_s(t_s);
    const auto at = PoseAt(reference_, on_reference_s), later = PoseAt(reference_, on_reference_s + kTimeStep_s),
               earlier = PoseAt(reference_, on_reference_s - kTimeStep_s);
    if (!at || !later || !earlier) return std::nullopt;
    const Se3 there = T_sensor_reference_ * *at;
    const Vector6d speed = Apart(T_sensor_reference_ * *later, T_sensor_reference_ * *earlier) / (2 * kTimeStep_s);
    Row row;
    row.residual = Apart(there, sensor_[j].T_cam_board);
    row.J.setZero();
    row.J.topLeftCorner<3, 3>().setIdentity();
    row.J.block<3, 3>(0, 3) = -Hat(there * centre_m_);
    row.J.block<3, 3>(3, 3).setIdentity();
    row.J.col(6) = -speed;
    row.J.col(7) = -speed * (t_s - fit_.at_s);
    row.block = j * kBlocks / sensor_.size();
    return row;
  }

  // Of the board's middle, and of its turning, in the sensor's frame.
  [[nodiscard]] Vector6d Apart(const Se3& T, const Se3& S) const {
    Se3 turned;
    turned.q = T.q * S.q.inverse();
    Vector6d apart;
    apart << T * centre_m_ - S * centre_m_, turned.Normalized().Log().tail<3>();
    return apart;
  }

  // Sets scale_, H_ and g_ of every block.
  bool Linearise() {
    std::vector<Row> rows;
    for (std::size_t j = 0; j < sensor_.size(); ++j)
      if (auto row = RowOf(j)) rows.push_back(*row);
    if (rows.size() < kPosesMin) return false;
    for (int k = 0; k < 6; ++k) {
      std::vector<double> sizes;
      for (const Row& row : rows) sizes.push_back(std::abs(row.residual[k]));
      std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
      scale_[k] = std::max(1e-7, 1.4826 * sizes[sizes.size() / 2]);
    }
    H_.assign(kBlocks, Normal::Zero());
    g_.assign(kBlocks, Unknowns::Zero());
    for (const Row& row : rows) AddRow(row);
    return true;
  }
  void AddRow(const Row& row) {
    for (int k = 0; k < 6; ++k) {
      const double in_sigmas = std::abs(row.residual[k]) / scale_[k];
      const double weight = (in_sigmas > kHuber_sigmas ? kHuber_sigmas / in_sigmas : 1.0) / (scale_[k] * scale_[k]);
      H_[row.block] += weight * row.J.row(k).transpose() * row.J.row(k);
      g_[row.block] += weight * row.J.row(k).transpose() * row.residual[k];
    }
  }

  // What the unknowns change by, without one block (kBlocks: with all).
  [[nodiscard]] Unknowns Change(std::size_t without) const {
    Normal H = Normal::Zero();
    Unknowns g = Unknowns::Zero();
    for (std::size_t b = 0; b < kBlocks; ++b)
      if (b != without) H += H_[b], g += g_[b];
    const double known = 1 / (kDriftSigma_ratio * kDriftSigma_ratio);
    H(7, 7) += known;
    g[7] += known * fit_.drift_ratio;
    return -H.ldlt().solve(g);
  }

  bool Step() {
    if (!Linearise()) return false;
    const Unknowns change = Change(kBlocks);
    if (!change.allFinite()) return false;
    T_sensor_reference_.p_m += change.head<3>() + change.segment<3>(3).cross(T_sensor_reference_.p_m);
    Vector6d turn = Vector6d::Zero();
    turn.tail<3>() = change.segment<3>(3);
    T_sensor_reference_.q = (Se3::Exp(turn).q * T_sensor_reference_.q).normalized();
    fit_.offset_s += std::clamp(change[6], -0.02, 0.02);
    fit_.drift_ratio += change[7];
    return std::abs(fit_.offset_s) <= 1.2 * kClockOff_sMax;
  }

  void Jackknife() {
    std::vector<Unknowns> changes;
    Unknowns mean = Unknowns::Zero();
    for (std::size_t b = 0; b < kBlocks; ++b) {
      changes.push_back(Change(b));
      mean += changes.back() / kBlocks;
    }
    Unknowns squares = Unknowns::Zero();
    for (const Unknowns& change : changes) squares += (change - mean).cwiseAbs2();
    const Unknowns sigma = kOfFewBlocks * (squares * ((kBlocks - 1.0) / kBlocks)).cwiseSqrt();
    fit_.offset_sigma_s = std::max(kSigmaMin_s, sigma[6]);
    fit_.drift_sigma_ratio = sigma[7];
  }

  const std::vector<TimedPose>&reference_, &sensor_;
  Eigen::Vector3d centre_m_;
  Se3 T_sensor_reference_;
  ClockFit fit_;
  Vector6d scale_ = Vector6d::Ones();
  std::vector<Normal> H_;
  std::vector<Unknowns> g_;
};

}  // namespace

double ClockFit::SigmaAt_s(double t_s) const { return std::hypot(offset_sigma_s, drift_sigma_ratio * (t_s - at_s)); }

std::optional<ClockFit> FitClock(const std::vector<TimedPose>& reference, const std::vector<TimedPose>& sensor,
                                 const Eigen::Vector3d& centre_board_m) {
  if (reference.size() < kPosesMin || sensor.size() < kPosesMin) return std::nullopt;
  const auto speeds = SpeedsOf(reference, centre_board_m), others = SpeedsOf(sensor, centre_board_m);
  if (!Moves(speeds) || !Moves(others)) return std::nullopt;
  const auto offset_s = CoarseOffset_s(speeds, others);
  if (!offset_s) return std::nullopt;
  return Fitter(reference, sensor, centre_board_m).Fit(*offset_s);
}

}  // namespace rigcal::moments
