rigcal_program(graph_bench SOURCES bench/graph/graph_bench.cc bench/graph/graph_reference.cc
  DEPS rigcal_graph rigcal_formats Ceres::ceres)

rigcal_test(graph_test COMPUTES
  SOURCES unit/graph/solve_test.cc unit/graph/uncertainty/uncertainty_test.cc unit/graph/uncertainty/pose_changes_test.cc unit/graph/observability_test.cc
          unit/graph/of_test.cc unit/graph/weak_edges_test.cc unit/graph/g2o_test.cc unit/graph/data_test.cc unit/graph/live_test.cc
  DEPS rigcal_graph rigcal_formats)
rigcal_unite(graph_test)

# Ceres's templates are compiled once for both of its tests.
rigcal_library(graph_ceres SOURCES unit/graph/ceres.cc DEPS rigcal_graph Ceres::ceres)

rigcal_test(graph_numbers_test COMPUTES
  SOURCES unit/graph/large/numbers_test.cc unit/graph/large/lanes_test.cc unit/graph/large/clique_tree_test.cc
  DEPS rigcal_graph rigcal_formats graph_ceres)

rigcal_test(graph_honesty_test COMPUTES
  SOURCES unit/graph/uncertainty/jackknife_test.cc unit/graph/uncertainty/joint_poses_test.cc unit/graph/uncertainty/weights_test.cc unit/graph/suspects_test.cc unit/graph/insight_test.cc unit/graph/influence_test.cc
          unit/graph/uncertainty/measured_part_test.cc unit/graph/fusion/fuse_sessions_test.cc unit/graph/fusion/islands_test.cc unit/graph/fusion/moved_between_test.cc unit/graph/fusion/moved_long_ago_test.cc unit/graph/fusion/random_walk_test.cc unit/graph/fusion/apart_test.cc unit/graph/fusion/merge_edges_test.cc unit/graph/fusion/merge_apart_test.cc unit/graph/fusion/joined_information_test.cc unit/graph/fusion/merge_sessions_test.cc
  DEPS rigcal_graph rigcal_formats)
rigcal_unite(graph_honesty_test)
rigcal_test(graph_property_test COMPUTES
  SOURCES unit/graph/property_test.cc
  DEPS rigcal_graph rigcal_formats graph_ceres)
