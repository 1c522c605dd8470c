rigcal_test(math_test COMPUTES
  SOURCES unit/math_se3_test.cc unit/math_jacobian_test.cc unit/math_covariance_test.cc
          unit/math_covariance_monte_carlo_test.cc unit/math_observable_test.cc unit/math_statistics_test.cc unit/math_pooled_dof_test.cc
          unit/math_ball_distance_test.cc
  DEPS rigcal_math)
