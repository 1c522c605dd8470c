# Programs that deploy/measure runs; each prints JSON.
rigcal_program(durable_write_bench SOURCES bench/service/durable_write_bench.cc DEPS rigcal_base)
rigcal_program(png_bench SOURCES bench/service/png_bench.cc DEPS rigcal_import)
rigcal_program(receipt_recorder SOURCES bench/service/receipt_recorder.cc DEPS rigcal_idl)
rigcal_program(query_bench SOURCES bench/service/query_bench.cc DEPS rigcal_client)
rigcal_library(fleet_histories SOURCES bench/fleet/robot_history.cc DEPS rigcal_graph rigcal_fleet)
rigcal_program(fleet_measure
  SOURCES bench/fleet/fleet_measure.cc bench/fleet/drawn_fleet.cc bench/fleet/drawn_robot.cc bench/fleet/fleet_tally.cc
  DEPS fleet_histories rigcal_graph rigcal_fleet)
rigcal_program(fleet_history SOURCES bench/fleet/fleet_history.cc DEPS fleet_histories rigcal_graph rigcal_fleet)
rigcal_program(years_measure
  SOURCES bench/fleet/years_measure.cc bench/fleet/drawn_robot.cc
  DEPS fleet_histories rigcal_graph rigcal_fleet)
rigcal_program(misspelt_robots SOURCES bench/service/misspelt_robots.cc DEPS rigcal_idl)
rigcal_program(edge_load SOURCES bench/service/edge_load.cc DEPS rigcal_client)
rigcal_program(graph_honesty_measure SOURCES bench/graph/graph_honesty_measure.cc DEPS rigcal_graph)
rigcal_program(graph_faults_measure SOURCES bench/graph/graph_faults_measure.cc bench/graph/fault_graphs.cc DEPS rigcal_graph rigcal_fleet)
rigcal_program(board_speed_measure SOURCES bench/sensors/board_speed_measure.cc bench/sensors/board_pictures.cc DEPS rigcal_detect)
rigcal_program(cloud_measure SOURCES bench/sensors/cloud_measure.cc DEPS rigcal_cloud)
rigcal_program(page_store SOURCES bench/service/page_store.cc DEPS rigcal_pipeline rigcal_http)
# Simulated sessions of a rig, estimated: what several programs and tests measure.
rigcal_library(rig_sessions
  SOURCES bench/rig/feature_session.cc bench/rig/joint_session.cc bench/rig/rig_case.cc bench/rig/rig_edges.cc
          bench/rig/second_tracker.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph)
rigcal_library(trust_sessions
  SOURCES bench/trust/trust_session.cc bench/trust/told.cc bench/trust/told_words.cc bench/trust/found_plates.cc
  DEPS rig_sessions rigcal_fleet rigcal_detect)
rigcal_program(rig_measure SOURCES bench/rig/rig_measure.cc DEPS rig_sessions rigcal_sim rigcal_calib rigcal_graph)
rigcal_program(tracker_lidar_simulation
  SOURCES bench/pairs/tracker_lidar_simulation.cc
  DEPS rig_sessions calib_virtual rigcal_sim rigcal_calib rigcal_graph)
rigcal_program(rig_coverage
  SOURCES bench/rig/rig_coverage_main.cc bench/rig/rig_coverage.cc bench/rig/rig_motions.cc bench/rig/rig_given.cc bench/rig/rig_turned.cc bench/rig/rig_bytes.cc
  DEPS rig_sessions rigcal_sim rigcal_calib rigcal_graph TBB::tbb)
rigcal_unite(rig_coverage)
rigcal_program(sigma_chance
  SOURCES bench/rig/sigma_chance.cc
  DEPS rig_sessions rigcal_sim rigcal_calib rigcal_graph)
rigcal_program(trust_measure
  SOURCES bench/trust/trust_measure.cc bench/trust/trust_scenarios.cc bench/trust/trust_json.cc bench/pairs/stereo_splits.cc bench/pairs/stereo_pictures.cc
  DEPS trust_sessions rig_sessions rigcal_sim rigcal_calib rigcal_graph rigcal_fleet rigcal_detect rigcal_formats)
rigcal_program(joint_measure
  SOURCES bench/rig/joint_measure.cc
  DEPS rig_sessions rigcal_sim rigcal_calib rigcal_graph)
rigcal_program(joint_peer
  SOURCES bench/rig/joint_peer.cc
  DEPS rig_sessions rigcal_sim rigcal_calib rigcal_graph Ceres::ceres)
rigcal_program(companion_measure
  SOURCES bench/companion/companion_measure.cc bench/companion/held_board.cc
  DEPS rigcal_companion rigcal_sim rigcal_calib rigcal_formats)
rigcal_program(stream_frames SOURCES bench/stream/stream_frames.cc bench/stream/waved_board.cc DEPS rigcal_sim)
