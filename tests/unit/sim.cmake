rigcal_library(sim_sample SOURCES unit/client/sim/sample.cc DEPS rigcal_sim rigcal_formats)
rigcal_test(sim_test COMPUTES
  SOURCES unit/client/sim/rig_test.cc unit/client/sim/lens_test.cc unit/client/sim/scan_test.cc unit/client/sim/bound_test.cc unit/client/sim/session_test.cc unit/client/sim/calibration_test.cc
          unit/client/sim/disturbance_test.cc
          unit/client/sim/mounts_test.cc
  DEPS sim_sample rigcal_sim rigcal_formats rigcal_calib)
rigcal_unite(sim_test)
rigcal_test(sim_picture_test COMPUTES
  SOURCES unit/client/sim/picture_test.cc unit/client/sim/plate_test.cc unit/client/sim/printed_board_test.cc
  DEPS sim_sample rigcal_sim rigcal_detect)
rigcal_test(sim_lidar_pair_test COMPUTES
  SOURCES unit/client/sim/lidar_pair_test.cc
  DEPS rig_sessions rigcal_sim rigcal_calib rigcal_graph)
rigcal_test(trust_words_test
  SOURCES unit/bench/trust_words_test.cc
  DEPS trust_sessions rigcal_calib rigcal_graph rigcal_sim)
rigcal_test(trust_session_test COMPUTES
  SOURCES unit/bench/trust_session_test.cc
  DEPS trust_sessions rig_sessions rigcal_sim rigcal_calib rigcal_graph rigcal_fleet rigcal_detect)
