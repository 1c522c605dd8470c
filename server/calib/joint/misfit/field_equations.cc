#include <algorithm>

#include "server/base/process/parallel_for.h"
#include "server/calib/joint/misfit/lens_misfit.h"

namespace rigcal::calib::joint {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kPlacesAtOnce = 64;
constexpr double kReached = 0.1;  // corners at a control point: what fewer say of it is nothing

struct CameraLook {
  int camera = kNone;
  FieldLook look;
};
// A place's pose by the field of one camera.
struct PlaceByField {
  int camera = kNone;
  Eigen::Matrix<double, 6, Eigen::Dynamic> cross, solved;  // by_place^T A B, and the place's inverse times it
};
struct PlaceTerms {
  std::vector<CameraLook> looks;
  std::vector<PlaceByField> cameras;  // ascending
};

std::vector<std::vector<int>> SeenPoints(const SessionProblem& problem) {
  std::vector<VectorXd> reached;
  for (const Lens& lens : problem.cameras) reached.emplace_back(VectorXd::Zero(FieldGridOf(lens.picture).points()));
  for (const CornersSeen& seen : problem.corners) {
    const auto camera = static_cast<std::size_t>(seen.camera);
    const FieldGrid grid = FieldGridOf(problem.cameras[camera].picture);
    for (std::size_t i = 0; i < seen.corners.size() && grid.points() > 0; ++i) {
      const FieldWeights field = FieldWeightsAt(grid, seen.corners.uv_px[i]);
      for (std::size_t k = 0; k < field.point.size(); ++k) reached[camera][field.point[k]] += field.weight[k];
    }
  }
  std::vector<std::vector<int>> points(reached.size());
  for (std::size_t camera = 0; camera < reached.size(); ++camera)
    for (int k = 0; k < reached[camera].size(); ++k)
      if (reached[camera][k] > kReached) points[camera].push_back(k);
  return points;
}

class Accumulator {
 public:
  Accumulator(const SessionProblem& problem, const Refined& refined)
      : problem_(problem), refined_(refined), seen_points_(SeenPoints(problem)) {
    effects_.at = {0};
    for (const auto& points : seen_points_)
      effects_.at.push_back(effects_.at.back() + 2 * static_cast<int>(points.size()));
    effects_.S = MatrixXd::Zero(effects_.at.back(), effects_.at.back());
    effects_.score = VectorXd::Zero(effects_.at.back());
    X_ = MatrixXd::Zero(refined.layout.columns, effects_.at.back());
    looks_.resize(problem.capture_of_place.size());
    for (std::size_t i = 0; i < problem.corners.size(); ++i)
      if (effects_.size(static_cast<std::size_t>(problem.corners[i].camera)) > 0)
        looks_[static_cast<std::size_t>(problem.corners[i].place)].push_back(i);
  }

  FieldEquations Run() {
    for (std::size_t from = 0; from < looks_.size(); from += kPlacesAtOnce)
      Add(from, std::min(looks_.size(), from + kPlacesAtOnce));
    EliminateShared();
    AddHeld();
    return {std::move(seen_points_), std::move(effects_), std::move(by_unknowns_)};
  }

 private:
  void Add(std::size_t from, std::size_t to) {
    std::vector<PlaceTerms> places(to - from);
    ParallelFor(places.size(), [&](std::size_t i) { places[i] = TermsOf(from + i); });
    ParallelFor(problem_.cameras.size(), [&](std::size_t camera) {
      for (std::size_t i = 0; i < places.size(); ++i)
        AddPlace(static_cast<int>(camera), places[i], refined_.at_optimum.places[from + i]);
    });
  }

  [[nodiscard]] PlaceTerms TermsOf(std::size_t place) const {
    PlaceTerms terms;
    for (const std::size_t i : looks_[place]) {
      const CornersSeen& seen = problem_.corners[i];
      auto look = ObserveWithField(problem_, refined_.layout, refined_.state, seen,
                                   refined_.noise[static_cast<std::size_t>(seen.sensor)], refined_.weights.OfCorners(i),
                                   seen_points_[static_cast<std::size_t>(seen.camera)]);
      if (look) AddLook({seen.camera, std::move(*look)}, terms);
    }
    const Matrix6d& inverse = refined_.at_optimum.places[place].inverse;
    for (PlaceByField& one : terms.cameras) one.solved = inverse * one.cross;
    return terms;
  }

  static void AddLook(CameraLook look, PlaceTerms& terms) {
    auto at = std::find_if(terms.cameras.begin(), terms.cameras.end(),
                           [&](const PlaceByField& one) { return one.camera >= look.camera; });
    const Eigen::Matrix<double, 6, Eigen::Dynamic> cross = look.look.plain.by_place.transpose() * look.look.own_field;
    if (at == terms.cameras.end() || at->camera != look.camera)
      terms.cameras.insert(at, {look.camera, cross, {}});
    else
      at->cross += cross;
    terms.looks.push_back(std::move(look));
  }

  // Rows of one camera, of blocks up to its own.
  void AddPlace(int camera, const PlaceTerms& terms, const PlaceEquations& place) {
    const auto own = std::find_if(terms.cameras.begin(), terms.cameras.end(),
                                  [&](const PlaceByField& one) { return one.camera == camera; });
    if (own == terms.cameras.end()) return;
    const int at = effects_.at[static_cast<std::size_t>(camera)],
              size = effects_.size(static_cast<std::size_t>(camera));
    for (const CameraLook& look : terms.looks)
      if (look.camera == camera) AddOwn(at, look.look);
    effects_.score.segment(at, size) -= own->solved.transpose() * place.b;
    X_.middleCols(at, size).noalias() -= place.by_shared.transpose() * own->solved;
    for (auto other = terms.cameras.begin(); other <= own; ++other)
      effects_.S.block(at, effects_.at[static_cast<std::size_t>(other->camera)], size, other->cross.cols()).noalias() -=
          own->cross.transpose() * other->solved;
  }

  void AddOwn(int at, const FieldLook& look) {
    const Eigen::Index points = look.by_points.rows();
    effects_.S.block(at, at, points, points) += look.by_points;
    effects_.S.block(at + points, at + points, points, points) += look.by_points;
    if (look.by_error.rows() > 0)
      effects_.S.block(at, at, 2 * points, 2 * points) -= look.by_error.transpose() * look.by_error;
    effects_.score.segment(at, 2 * points) += look.b;
    for (const Column& column : look.plain.columns)
      X_.block(column.at, at, column.by.cols(), 2 * points).noalias() += column.by.transpose() * look.own_field;
  }

  void EliminateShared() {
    const int size = refined_.layout.size;
    const MatrixXd X = X_.topRows(size);
    const VectorXd b = refined_.at_optimum.total.b.head(size);
    by_unknowns_.resize(size, X.cols());
    ParallelFor(problem_.cameras.size(), [&](std::size_t k) {
      const int at = effects_.at[k], count = effects_.size(k);
      by_unknowns_.middleCols(at, count).noalias() = refined_.covariance * X.middleCols(at, count);
    });
    ParallelFor(problem_.cameras.size(), [&](std::size_t k) {
      const int at = effects_.at[k], count = effects_.size(k);
      effects_.S.block(at, 0, count, at + count).noalias() -=
          X.middleCols(at, count).transpose() * by_unknowns_.leftCols(at + count);
    });
    effects_.S.triangularView<Eigen::StrictlyUpper>() = effects_.S.transpose();
    effects_.score -= by_unknowns_.transpose() * b;
  }

  void AddHeld() {
    VectorXd held = VectorXd::Zero(effects_.score.size());
    for (std::size_t k = 0; k < refined_.state.field_px.size(); ++k) {
      const VectorXd& field_px = refined_.state.field_px[k];
      const Eigen::Index seen = effects_.size(k) / 2, all = field_px.size() / 2;
      if (all == 0) continue;
      held.segment(effects_.at[k], seen) = field_px.head(all)(seen_points_[k]);
      held.segment(effects_.at[k] + seen, seen) = field_px.tail(all)(seen_points_[k]);
    }
    effects_.score -= effects_.S * held;
  }

  const SessionProblem& problem_;
  const Refined& refined_;
  std::vector<std::vector<int>> seen_points_;
  RandomEffects effects_;
  MatrixXd X_, by_unknowns_;
  std::vector<std::vector<std::size_t>> looks_;  // of corners, per place
};

}  // namespace

FieldEquations FieldEquationsOf(const SessionProblem& problem, const Refined& refined) {
  return Accumulator(problem, refined).Run();
}

}  // namespace rigcal::calib::joint
