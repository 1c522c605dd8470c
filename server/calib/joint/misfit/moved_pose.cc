#include "server/calib/joint/misfit/moved_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

#include "server/base/process/parallel_for.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kUnmeasuredRatio = 1e-6;  // of the sensor's own information: less is what rounding leaves

// Groups, or captures of one, in which a sensor must have seen something on either side of a change: one or two
// pictures may be of another instant.
constexpr std::size_t kGroupsMin = 2, kCapturesMin = 3;

constexpr double kAlike = 1e-4;  // ratio of two gains, less 1: what rounding makes of two that are the same

constexpr double kPower = 0.95, kPowerSigmas = 1.645;  // P(z < kPowerSigmas) = kPower

// Pseudo-inverse and rank of an information matrix, along what `whole` tells and it does not lack.
struct Inverse {
  Matrix6d matrix = Matrix6d::Zero();
  Matrix6d of = Matrix6d::Zero();  // H without what counts as rounding
  int rank = 0;
};
Inverse InverseOf(const Matrix6d& H, const Matrix6d& whole) {
  const Vector6d scale = UnitDiagonal(whole);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(scale.asDiagonal() * H * scale.asDiagonal());
  Inverse inverse;
  Vector6d values = Vector6d::Zero(), inverted = Vector6d::Zero();
  for (int i = 0; i < 6; ++i)
    if (axes.eigenvalues()[i] > kUnmeasuredRatio)
      values[i] = axes.eigenvalues()[i], inverted[i] = 1 / values[i], ++inverse.rank;
  const Matrix6d half = scale.asDiagonal() * axes.eigenvectors(),
                 other = scale.cwiseInverse().asDiagonal() * axes.eigenvectors();
  inverse.matrix = half * inverted.asDiagonal() * half.transpose();
  inverse.of = other * values.asDiagonal() * other.transpose();
  return inverse;
}

// What the groups say of one pose by its own columns, from `at` on.
struct Scores {
  std::vector<Vector6d> b;
  Eigen::MatrixXd whitened;        // L^-1 H_g^T, six columns a group: H_g of its columns with the unknowns, H = L L^T
  std::vector<Matrix6d> taken_up;  // H_g C H_g^T: of the group's own by the unknowns
  std::vector<Matrix6d> own;
  std::vector<Inverse> own_inverse;
  std::vector<std::size_t> captures;  // that see the sensor, or the board
};
using CapturesOfGroups = std::vector<std::size_t>;

// A board that is carried about makes a place of its own in each capture.
template <typename IsOf>
CapturesOfGroups CapturesIn(const SessionProblem& problem, const CaptureGroups& groups, const IsOf& is_of) {
  std::vector<std::set<int>> captures(static_cast<std::size_t>(groups.groups()));
  ForEachLook(problem, [&](const Where& look) {
    const auto place = static_cast<std::size_t>(look.place);
    if (is_of(look))
      captures[static_cast<std::size_t>(groups.group_of_place[place])].insert(problem.capture_of_place[place]);
  });
  CapturesOfGroups counts;
  for (const std::set<int>& of_group : captures) counts.push_back(of_group.size());
  return counts;
}
CapturesOfGroups CapturesOfSensor(const SessionProblem& problem, const Refined& refined, int sensor) {
  return CapturesIn(problem, refined.groups, [&](const Where& look) { return look.sensor == sensor; });
}
CapturesOfGroups CapturesOfBoard(const SessionProblem& problem, const Refined& refined, int board) {
  return CapturesIn(problem, refined.groups, [&](const Where& look) { return look.board == board; });
}

// The unknowns' information as L L^T, each in its own unit.
struct Whitener {
  Eigen::VectorXd scale;
  Eigen::LLT<Eigen::MatrixXd> llt;
  explicit Whitener(const Refined& refined) {
    const auto size = refined.layout.size;
    const auto H = refined.at_optimum.total.H.topLeftCorner(size, size);
    scale = H.diagonal().cwiseSqrt().cwiseInverse();
    llt.compute(scale.asDiagonal() * H * scale.asDiagonal());
  }
};

Eigen::Index First(std::size_t group) { return 6 * static_cast<Eigen::Index>(group); }

Scores ScoresOf(const Refined& refined, const Whitener& whitener, int at, CapturesOfGroups captures) {
  const auto& groups = refined.at_optimum.groups;
  Scores scores;
  scores.captures = std::move(captures);
  scores.whitened.resize(refined.layout.size, First(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    scores.b.emplace_back(groups[g].b.segment<6>(at));
    scores.whitened.middleCols<6>(First(g)) =
        whitener.scale.asDiagonal() * groups[g].H.middleRows(at, 6).leftCols(refined.layout.size).transpose();
    scores.own.emplace_back(groups[g].H.block<6, 6>(at, at));
    scores.own_inverse.push_back(InverseOf(scores.own.back(), scores.own.back()));
  }
  whitener.llt.matrixL().solveInPlace(scores.whitened);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto of_group = scores.whitened.middleCols<6>(First(g));
    scores.taken_up.emplace_back(of_group.transpose() * of_group);
  }
  return scores;
}

// H_g C (sum of H from a change on)^T: six rows a group, six columns a change.
Eigen::MatrixXd SharedWith(const Scores& scores, const std::vector<std::size_t>& changes) {
  Eigen::MatrixXd from(scores.whitened.rows(), First(changes.size())),
      sum = Eigen::MatrixXd::Zero(scores.whitened.rows(), 6);
  std::size_t g = scores.b.size();
  for (std::size_t i = changes.size(); i-- > 0;) {
    while (g > changes[i]) sum += scores.whitened.middleCols<6>(First(--g));
    from.middleCols<6>(First(i)) = sum;
  }
  return scores.whitened.transpose() * from;
}

// A change from `group` on: the step that fits it best, and the gain of the cost.
struct Change {
  Vector6d step = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero(), information = Matrix6d::Zero();
  double gain = 0.0;
  int rank = 0;
};
using Shared = Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, 6>>;
Change ChangeFrom(const Scores& scores, std::size_t group, const Shared& shared) {
  Vector6d b = Vector6d::Zero();
  Matrix6d own = Matrix6d::Zero(), taken_up = Matrix6d::Zero();
  for (std::size_t g = group; g < scores.b.size(); ++g) {
    b += scores.b[g];
    own += scores.own[g];
    taken_up += shared.middleRows<6>(First(g));
  }
  const Inverse inverse = InverseOf(own - taken_up, own);
  Change change;
  change.step = -inverse.matrix * b;
  change.covariance = inverse.matrix;
  change.information = inverse.of;
  change.gain = -b.dot(change.step);
  change.rank = inverse.rank;
  return change;
}

// Mean square of the groups' scores beside the change, and its degrees of freedom: what the unknowns and the change
// have taken up of a group's score is not there to scatter, its variance is own - H C H^T - A V^+ A^T.
struct Scatter {
  double mean_square = 1.0, dof = 0.0;
};
Scatter ScatterBeside(const Scores& scores, const Change& change, std::size_t group, const Shared& shared) {
  double squares = 0.0, dof = 0.0;
  for (std::size_t g = 0; g < scores.b.size(); ++g) {
    const Inverse& inverse = scores.own_inverse[g];
    Matrix6d A = -shared.middleRows<6>(First(g));
    Vector6d score = scores.b[g] + A * change.step;
    if (g >= group) score += scores.own[g] * change.step, A += scores.own[g];
    squares += score.dot(inverse.matrix * score);
    const Matrix6d lost = scores.taken_up[g] + A * change.covariance * A.transpose();
    dof += inverse.rank - (inverse.matrix * lost).trace();
  }
  return {dof > 0 ? squares / dof : 1.0, std::max(0.0, dof)};
}

// Per group, and behind the last: how many groups before it see the sensor.
std::vector<std::size_t> SeenBefore(const Scores& scores) {
  std::vector<std::size_t> seen_before = {0};
  for (const Matrix6d& own : scores.own) seen_before.push_back(seen_before.back() + (own.trace() > 0 ? 1 : 0));
  return seen_before;
}

std::size_t CapturesSeen(const Scores& scores) {
  return std::accumulate(scores.captures.begin(), scores.captures.end(), std::size_t{0});
}

// Enough of what a sensor saw for one side of a change.
bool IsSide(std::size_t groups, std::size_t captures) {
  return groups >= kGroupsMin || (groups > 0 && captures >= kCapturesMin);
}

// Groups at which a change would have enough on either side that see the sensor; `late`: enough before it, and less
// from it on.
std::vector<std::size_t> ChangePoints(const Scores& scores, bool late = false) {
  const std::vector<std::size_t> seen_before = SeenBefore(scores);
  const std::size_t captures = CapturesSeen(scores);
  std::vector<std::size_t> points;
  std::size_t captures_before = 0;
  for (std::size_t group = 1; group < scores.b.size(); ++group) {
    captures_before += scores.captures[group - 1];
    const std::size_t after = seen_before.back() - seen_before[group];
    const bool is_late = scores.captures[group] > 0 && !IsSide(after, captures - captures_before);
    if (IsSide(seen_before[group], captures_before) && after > 0 &&
        (late ? is_late : IsSide(after, captures - captures_before)))
      points.push_back(group);
  }
  return points;
}

Move LikeliestMove(const Scores& scores, const std::vector<std::size_t>& points) {
  Move best;
  const Eigen::MatrixXd all_shared = SharedWith(scores, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t group = points[i];
    const auto shared = all_shared.middleCols<6>(First(i));
    const Change change = ChangeFrom(scores, group, shared);
    if (change.rank == 0) continue;
    const Scatter scatter = ScatterBeside(scores, change, group, shared);
    const double statistic = change.gain / change.rank / std::max(scatter.mean_square, 1e-12);
    const double odds = FisherTail(statistic, change.rank, scatter.dof);
    if (best.statistic >= statistic) continue;
    best.group = static_cast<int>(group);
    best.step = change.step;
    best.gain = change.gain;
    best.statistic = statistic;
    best.odds = odds;
    best.scatter = scatter.mean_square;
    best.information = change.information / std::max(scatter.mean_square, 1e-12);
  }
  return best;
}

// Of `points`, not empty, the first with half of the groups that see the sensor before it.
std::size_t HalfWay(const Scores& scores, const std::vector<std::size_t>& points) {
  const std::vector<std::size_t> seen_before = SeenBefore(scores);
  const auto half = std::find_if(points.begin(), points.end(),
                                 [&](std::size_t group) { return 2 * seen_before[group] >= seen_before.back(); });
  return half == points.end() ? points.back() : *half;
}

// Largest standard deviation along any direction.
double WorstSigma(const Matrix6d& covariance, int at) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance.block<3, 3>(at, at), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues()[2]));
}

// Beyond the scan's limit, and surely larger than what is no move (IsMove).
double ToldFrom(double sigma, double noncentrality, double least) {
  return std::max(std::sqrt(noncentrality) * sigma, least + (kMovedMinSigmas + kPowerSigmas) * sigma);
}

// What the unknowns move by where the change is allowed for.
Eigen::VectorXd OthersOf(const Refined& refined, const Move& move) {
  const int at = move.board == kNone ? refined.layout.pose[static_cast<std::size_t>(move.sensor)]
                                     : refined.layout.board[static_cast<std::size_t>(move.board)];
  const auto& groups = refined.at_optimum.groups;
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(refined.layout.size);
  for (auto g = static_cast<std::size_t>(move.group); g < groups.size(); ++g)
    pull += groups[g].H.middleRows(at, 6).leftCols(refined.layout.size).transpose() * move.step;
  return -refined.covariance * pull;
}

// A sensor's newest pose is that after its step; where the reference makes it, all others are told from there.
void AddLastPose(const Refined& refined, const Move& move, Eigen::VectorXd& away) {
  const auto moved = static_cast<std::size_t>(move.sensor);
  const std::vector<int>& at = refined.layout.pose;
  if (at[moved] < refined.layout.size) {
    away.segment<6>(at[moved]) += move.step;
    return;
  }
  for (std::size_t s = 0; s < at.size(); ++s)
    if (s != moved) away.segment<6>(at[s]) -= Adjoint(refined.state.T_ref_sensor[s].Inverse()) * move.step;
}

// Two that explain the same, but for rounding: what each sees scatters as it may, so their statistics differ.
bool AreAlike(const Move& x, const Move& y) {
  return x.group == y.group && std::abs(x.gain - y.gain) <= kAlike * x.gain;
}

void NameAlternatives(std::vector<Move>& moves) {
  for (Move& move : moves)
    for (const Move& other : moves) {
      if (&move == &other || !AreAlike(move, other)) continue;
      if (other.sensor != kNone && move.or_sensor == kNone) move.or_sensor = other.sensor;
      if (other.board != kNone && move.or_board == kNone) move.or_board = other.board;
    }
}

// Of some that explain the same sensors stand before boards, and what is told before what it is told against.
void SortAlike(const Layout& layout, std::vector<Move>& moves) {
  const auto rank = [&](const Move& move) {
    const int at = move.board == kNone ? layout.pose[static_cast<std::size_t>(move.sensor)]
                                       : layout.board[static_cast<std::size_t>(move.board)];
    return (move.board == kNone ? 0 : 2) + (at < layout.size ? 0 : 1);
  };
  for (std::size_t i = 1; i < moves.size(); ++i)
    for (std::size_t k = i; k > 0 && AreAlike(moves[k - 1], moves[k]) && rank(moves[k]) < rank(moves[k - 1]); --k)
      std::swap(moves[k - 1], moves[k]);
}

// The likeliest first, their odds those of the whole scan: of so many changes of each.
std::vector<Move> Ranked(std::vector<Move> moves, const Refined& refined, int changes) {
  const double looks = static_cast<double>(moves.size()) * changes;
  for (Move& move : moves) move.odds = std::min(1.0, move.odds * looks);
  std::stable_sort(moves.begin(), moves.end(), [](const Move& x, const Move& y) {
    return x.odds != y.odds ? x.odds < y.odds : x.statistic > y.statistic;
  });
  SortAlike(refined.layout, moves);
  NameAlternatives(moves);
  return moves;
}

SmallestMove SmallestOf(const SessionProblem& problem, const Refined& refined, const Scores& scores) {
  SmallestMove told{kAnyMove_m, kAnyMove_rad, static_cast<int>(CapturesSeen(scores))};
  const std::vector<std::size_t> points = ChangePoints(scores);
  if (refined.groups.groups() < kGroupsForMoves || points.empty()) return told;
  const double looks =
      static_cast<double>(problem.sensors.size() + problem.boards.size()) * (refined.groups.groups() - 1);
  const std::size_t half_way = HalfWay(scores, points);
  const Eigen::MatrixXd shared = SharedWith(scores, {half_way});
  const Change change = ChangeFrom(scores, half_way, shared);
  const Scatter scatter = ScatterBeside(scores, change, half_way, shared);
  if (change.rank < 6 || scatter.dof <= 0) return told;
  const double limit = FisherQuantile(kMovedOdds / looks, change.rank, scatter.dof);
  const double noncentrality = FisherNoncentrality(limit, change.rank, scatter.dof, kPower);
  const Matrix6d covariance = std::max(scatter.mean_square, 1e-12) * change.covariance;
  told.m = std::min(kAnyMove_m, ToldFrom(WorstSigma(covariance, tangent::kTranslation), noncentrality, kMovedMin_m));
  told.rad = std::min(kAnyMove_rad, ToldFrom(WorstSigma(covariance, tangent::kRotation), noncentrality, kMovedMin_rad));
  return told;
}

}  // namespace

Eigen::MatrixXd CovarianceByMovesLeft(const SessionProblem& problem, const Refined& refined) {
  if (refined.groups.groups() < kGroupsForMoves) return {};
  Eigen::MatrixXd covariance;
  for (const Move& move : ScanForMoves(problem, refined)) {
    if (move.odds >= kMovedOdds) break;
    Eigen::VectorXd away = OthersOf(refined, move);
    if (move.sensor != kNone) AddLastPose(refined, move, away);
    if (covariance.size() == 0) covariance = Eigen::MatrixXd::Zero(away.size(), away.size());
    covariance += away * away.transpose();
  }
  return covariance;
}

std::vector<SmallestMove> SmallestMovesTold(const SessionProblem& problem, const Refined& refined,
                                            const std::vector<int>& sensors) {
  const Whitener whitener(refined);
  std::vector<SmallestMove> told(sensors.size());
  ParallelFor(sensors.size(), [&](std::size_t i) {
    const int at = refined.layout.pose[static_cast<std::size_t>(sensors[i])];
    told[i] =
        SmallestOf(problem, refined, ScoresOf(refined, whitener, at, CapturesOfSensor(problem, refined, sensors[i])));
  });
  return told;
}

std::vector<Move> ScanForMoves(const SessionProblem& problem, const Refined& refined) {
  const Whitener whitener(refined);
  std::vector<Move> moves;
  const auto look_for = [&](const std::vector<int>& columns, int Move::*which, const auto& captures_of) {
    std::vector<Move> each(columns.size());
    ParallelFor(columns.size(), [&](std::size_t i) {
      const Scores scores = ScoresOf(refined, whitener, columns[i], captures_of(problem, refined, static_cast<int>(i)));
      each[i] = LikeliestMove(scores, ChangePoints(scores));
      each[i].*which = static_cast<int>(i);
    });
    std::copy_if(each.begin(), each.end(), std::back_inserter(moves),
                 [](const Move& move) { return move.statistic > 0; });
  };
  look_for(refined.layout.pose, &Move::sensor, CapturesOfSensor);
  look_for(refined.layout.board, &Move::board, CapturesOfBoard);
  return Ranked(std::move(moves), refined, std::max(1, refined.groups.groups() - 1));
}

std::vector<Move> ScanForLateMoves(const SessionProblem& problem, const Refined& refined) {
  if (refined.groups.groups() < kGroupsForMoves) return {};
  std::vector<int> sensors;
  for (const auto& [name, last] : LastOfEach(problem)) sensors.push_back(last);
  const Whitener whitener(refined);
  std::vector<Move> moves(sensors.size());
  ParallelFor(sensors.size(), [&](std::size_t i) {
    const int at = refined.layout.pose[static_cast<std::size_t>(sensors[i])];
    const Scores scores = ScoresOf(refined, whitener, at, CapturesOfSensor(problem, refined, sensors[i]));
    moves[i] = LikeliestMove(scores, ChangePoints(scores, true));
    moves[i].sensor = sensors[i];
  });
  std::erase_if(moves, [](const Move& move) { return move.statistic <= 0; });
  moves = Ranked(std::move(moves), refined, 1);
  std::erase_if(moves, [](const Move& move) { return !IsMove(move.step, move.information, move.odds); });
  return moves;
}

}  // namespace rigcal::calib::joint
