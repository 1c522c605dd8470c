rigcal_test(calib_test COMPUTES
  SOURCES unit/calib_derivative_test.cc unit/calib_estimate_test.cc unit/calib_diagnosis_test.cc unit/calib_start_test.cc
          unit/calib_projection_test.cc unit/calib_projection_map_test.cc unit/calib_camera_fit_test.cc unit/calib_virtual_pair.cc
  DEPS rigcal_calib)
rigcal_test(calib_joint_test COMPUTES
  SOURCES unit/calib_joint_test.cc unit/calib_joint_bursts_test.cc unit/calib_joint_moves_test.cc unit/calib_joint_bend_test.cc unit/calib_joint_slant_test.cc unit/calib_lens_misfit_test.cc bench/joint_session.cc bench/feature_session.cc
  DEPS rigcal_calib rigcal_sim rigcal_graph TBB::tbb)
rigcal_test(calib_models_test COMPUTES
  SOURCES unit/calib_capture_blocks_test.cc unit/calib_pair_captures_test.cc unit/calib_models_test.cc unit/calib_symmetry_test.cc unit/calib_camera_test.cc unit/calib_virtual_pair.cc
  DEPS rigcal_calib)
rigcal_test(calib_lens_choice_test COMPUTES
  SOURCES unit/calib_lens_choice_test.cc unit/calib_virtual_pair.cc
  DEPS rigcal_calib)
rigcal_test(calib_given_intrinsics_test COMPUTES
  SOURCES unit/calib_given_intrinsics_test.cc unit/calib_virtual_pair.cc unit/calib_virtual_motion.cc
  DEPS rigcal_calib)
rigcal_test(calib_statistics_test COMPUTES WHOLE
  SOURCES unit/calib_statistics_test.cc unit/calib_virtual_pair.cc
  DEPS rigcal_calib)
rigcal_test(calib_real_test COMPUTES
  SOURCES unit/calib_real_test.cc unit/calib_fisheye_real_test.cc unit/calib_wide_real_test.cc
  DEPS rigcal_calib rigcal_detect)
rigcal_program(stereo_measure
  SOURCES bench/stereo_measure.cc bench/stereo_pictures.cc
  DEPS rigcal_calib rigcal_detect)
rigcal_test(calib_lidar_camera_test COMPUTES
  SOURCES unit/calib_lidar_camera_test.cc unit/calib_one_plane_test.cc unit/calib_plane_moments_test.cc
          unit/calib_virtual_lidar.cc
  DEPS rigcal_calib)
rigcal_program(lidar_camera_measure
  SOURCES bench/lidar_camera_measure.cc
  DEPS rigcal_calib rigcal_detect rigcal_formats)
rigcal_program(hand_eye_measure
  SOURCES bench/hand_eye_measure.cc
  DEPS rigcal_calib rigcal_detect rigcal_formats)
rigcal_test(calib_lidar_lidar_test COMPUTES
  SOURCES unit/calib_lidar_lidar_test.cc unit/calib_lidar_lidar_statistics_test.cc unit/calib_virtual_room.cc
  DEPS rigcal_calib TBB::tbb)
rigcal_program(lidar_lidar_measure
  SOURCES bench/lidar_lidar_measure.cc
  DEPS rigcal_calib rigcal_formats TBB::tbb)
rigcal_program(lidar_lidar_room
  SOURCES bench/lidar_lidar_room.cc unit/calib_virtual_room.cc
  DEPS rigcal_calib)
rigcal_program(hand_eye_simulation
  SOURCES bench/hand_eye_simulation.cc unit/calib_virtual_motion.cc
  DEPS rigcal_calib)
rigcal_test(calib_hand_eye_test COMPUTES
  SOURCES unit/calib_hand_eye_test.cc unit/calib_hand_eye_statistics_test.cc unit/calib_board_scale_test.cc
          unit/calib_virtual_motion.cc
  DEPS rigcal_calib)
rigcal_test(calib_tracker_lidar_test COMPUTES
  SOURCES unit/calib_tracker_lidar_test.cc unit/calib_virtual_planes.cc unit/calib_virtual_motion.cc
  DEPS rigcal_calib)
