# Programs that deploy/measure runs; each prints JSON.
rigcal_program(durable_write_bench SOURCES bench/durable_write_bench.cc DEPS rigcal_base)
rigcal_program(receipt_recorder SOURCES bench/receipt_recorder.cc DEPS rigcal_idl)
rigcal_program(query_bench SOURCES bench/query_bench.cc DEPS rigcal_client)
rigcal_program(fleet_measure
  SOURCES bench/fleet/fleet_measure.cc bench/fleet/drawn_fleet.cc bench/fleet/drawn_robot.cc bench/fleet/fleet_tally.cc
          bench/fleet/robot_history.cc
  DEPS rigcal_graph rigcal_fleet)
rigcal_program(fleet_history SOURCES bench/fleet/fleet_history.cc bench/fleet/robot_history.cc DEPS rigcal_graph rigcal_fleet)
rigcal_program(misspelt_robots SOURCES bench/misspelt_robots.cc DEPS rigcal_idl)
rigcal_program(edge_load SOURCES bench/edge_load.cc DEPS rigcal_client)
rigcal_program(graph_honesty_measure SOURCES bench/graph_honesty_measure.cc DEPS rigcal_graph)
rigcal_program(graph_faults_measure SOURCES bench/graph_faults_measure.cc bench/fault_graphs.cc DEPS rigcal_graph rigcal_fleet)
rigcal_program(board_speed_measure SOURCES bench/board_speed_measure.cc bench/board_pictures.cc DEPS rigcal_detect)
rigcal_program(cloud_measure SOURCES bench/cloud_measure.cc DEPS rigcal_cloud)
rigcal_program(page_store SOURCES bench/page_store.cc DEPS rigcal_pipeline rigcal_http)
rigcal_program(rig_measure SOURCES bench/rig_measure.cc bench/rig_edges.cc DEPS rigcal_sim rigcal_calib rigcal_graph)
rigcal_program(tracker_lidar_simulation
  SOURCES bench/tracker_lidar_simulation.cc bench/rig_edges.cc unit/calib_virtual_planes.cc unit/calib_virtual_motion.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph)
rigcal_program(rig_coverage
  SOURCES bench/rig_coverage_main.cc bench/rig_coverage.cc bench/rig_motions.cc bench/rig_given.cc bench/rig_turned.cc bench/rig_bytes.cc
          bench/rig_case.cc bench/feature_session.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph TBB::tbb)
rigcal_program(sigma_chance
  SOURCES bench/sigma_chance.cc bench/rig_case.cc bench/feature_session.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph)
rigcal_program(trust_measure
  SOURCES bench/trust_measure.cc bench/trust_scenarios.cc bench/trust_session.cc bench/trust_json.cc bench/told.cc bench/told_words.cc
          bench/found_plates.cc bench/feature_session.cc bench/joint_session.cc bench/stereo_splits.cc bench/stereo_pictures.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph rigcal_fleet rigcal_detect rigcal_formats)
rigcal_program(joint_measure
  SOURCES bench/joint_measure.cc bench/joint_session.cc bench/rig_case.cc bench/feature_session.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph)
