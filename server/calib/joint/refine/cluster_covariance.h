// Covariance of the refined sensor poses from how groups of captures disagree (cluster sandwich, CR2), shrunk towards
// the model's H^-1 and never below it.
#pragma once

#include "server/calib/joint/refine/refine.h"

namespace rigcal::calib::joint {

struct PoseCovariance {
  std::vector<int> row_of_sensor;  // first of six rows in `joint`; kNone: the reference
  Eigen::MatrixXd joint;           // right tangents
  Eigen::MatrixXd common;  // part of `joint` that errs alike on every visit: constants of lenses, boards, ranges
  Eigen::MatrixXd without_beside;  // the same as if nothing had been held
  Eigen::MatrixXd model;           // H^-1 of the same rows
  Eigen::MatrixXd influence;  // columns: what each group moves the poses by; their outer products sum to the sandwich
  double model_ratio = 1.0;   // share of the model in `joint`
  double spread_ratio = 1.0;  // variance between groups over what the model expects; about 1 where it holds
  std::vector<double> dof;    // per sensor, behind its six rows of `joint`; 0: known
};

// `beside`, `of_visit`: covariance of the layout's unknowns by what the refinement held, alike on every visit, and on
// this one alone; both are added to what is found. Empty: none.
[[nodiscard]] PoseCovariance CovarianceOfPoses(const Refined& refined, const Eigen::MatrixXd& beside = {},
                                               const Eigen::MatrixXd& of_visit = {});

}  // namespace rigcal::calib::joint
