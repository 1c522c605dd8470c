rigcal_test(metrics_test
  SOURCES unit/metrics/exposition_test.cc
  DEPS rigcal_metrics)
