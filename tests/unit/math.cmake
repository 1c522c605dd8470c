rigcal_test(math_test COMPUTES
  SOURCES unit/math/se3_test.cc unit/math/jacobian_test.cc unit/math/covariance_test.cc
          unit/math/covariance_monte_carlo_test.cc unit/math/observable_test.cc unit/math/statistics_test.cc unit/math/log_variance_test.cc unit/math/pooled_dof_test.cc unit/math/shrunk_scatter_test.cc
          unit/math/ball_distance_test.cc
  DEPS rigcal_math)
rigcal_unite(math_test)
