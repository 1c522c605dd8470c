rigcal_program(graph_bench SOURCES bench/graph_bench.cc bench/graph_reference.cc
  DEPS rigcal_graph rigcal_formats Ceres::ceres)

rigcal_test(graph_test COMPUTES
  SOURCES unit/graph_solve_test.cc unit/graph_uncertainty_test.cc unit/graph_observability_test.cc
          unit/graph_of_test.cc unit/graph_g2o_test.cc unit/graph_data_test.cc unit/graph_live_test.cc
  DEPS rigcal_graph rigcal_formats)

# Ceres's templates are compiled once for both of its tests.
rigcal_library(graph_ceres SOURCES unit/graph_ceres.cc DEPS rigcal_graph Ceres::ceres)

rigcal_test(graph_numbers_test COMPUTES
  SOURCES unit/graph_numbers_test.cc unit/graph_lanes_test.cc unit/clique_tree_test.cc
  DEPS rigcal_graph rigcal_formats graph_ceres)

rigcal_test(graph_honesty_test COMPUTES
  SOURCES unit/graph_jackknife_test.cc unit/graph_joint_poses_test.cc unit/graph_weights_test.cc unit/graph_suspects_test.cc unit/graph_insight_test.cc
          unit/graph_measured_part_test.cc unit/graph_fuse_sessions_test.cc unit/graph_merge_edges_test.cc unit/graph_merge_sessions_test.cc
  DEPS rigcal_graph rigcal_formats)
rigcal_test(graph_property_test COMPUTES
  SOURCES unit/graph_property_test.cc
  DEPS rigcal_graph rigcal_formats graph_ceres)
