rigcal_test(sim_test COMPUTES
  SOURCES unit/sim_rig_test.cc unit/sim_lens_test.cc unit/sim_scan_test.cc unit/sim_bound_test.cc unit/sim_session_test.cc unit/sim_calibration_test.cc
          unit/sim_disturbance_test.cc
          unit/sim_sample.cc
  DEPS rigcal_sim rigcal_formats rigcal_calib)
rigcal_test(sim_picture_test COMPUTES
  SOURCES unit/sim_picture_test.cc unit/sim_plate_test.cc unit/sim_sample.cc
  DEPS rigcal_sim rigcal_detect)
rigcal_test(sim_lidar_pair_test COMPUTES
  SOURCES unit/sim_lidar_pair_test.cc bench/feature_session.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph)
rigcal_test(trust_words_test
  SOURCES unit/trust_words_test.cc bench/told_words.cc
  DEPS rigcal_calib rigcal_graph rigcal_sim)
rigcal_test(trust_session_test COMPUTES
  SOURCES unit/trust_session_test.cc bench/trust_session.cc bench/told.cc bench/found_plates.cc bench/feature_session.cc bench/joint_session.cc
  DEPS rigcal_sim rigcal_calib rigcal_graph rigcal_fleet rigcal_detect)
