# Simulated boards, rooms and motions that several programs measure.
rigcal_library(calib_virtual
  SOURCES unit/calib/virtual_cell.cc unit/calib/virtual_lidar.cc unit/calib/virtual_motion.cc unit/calib/virtual_pair.cc
          unit/calib/virtual_planes.cc unit/calib/virtual_room.cc
  DEPS rigcal_calib rigcal_sim)
rigcal_test(calib_test COMPUTES
  SOURCES unit/calib/derivative_test.cc unit/calib/stereo/estimate_test.cc unit/calib/diagnosis_test.cc unit/calib/stereo/start_test.cc
          unit/calib/camera/projection_test.cc unit/calib/camera/projection_map_test.cc unit/calib/camera/camera_fit_test.cc
  DEPS calib_virtual rigcal_calib rigcal_sim)
rigcal_unite(calib_test)
rigcal_test(calib_joint_test COMPUTES
  SOURCES unit/calib/joint/joint_test.cc unit/calib/joint/bursts_test.cc unit/calib/joint/moves_test.cc unit/calib/joint/ambiguous_moves_test.cc unit/calib/joint/chance_test.cc unit/calib/joint/held_back_test.cc unit/calib/joint/doubt_test.cc unit/calib/joint/bend_test.cc unit/calib/joint/print_strain_test.cc unit/calib/joint/slant_test.cc unit/calib/joint/pupil_test.cc unit/calib/joint/given_lens_test.cc unit/calib/joint/look_error_test.cc unit/calib/joint/clock_test.cc unit/calib/joint/second_tracker_test.cc unit/calib/joint/session_groups_test.cc unit/calib/joint/lens_misfit_test.cc unit/calib/joint/sphere_lens_test.cc
  DEPS rig_sessions rigcal_calib rigcal_sim rigcal_graph TBB::tbb)
rigcal_unite(calib_joint_test)
rigcal_test(calib_models_test COMPUTES
  SOURCES unit/calib/capture_blocks_test.cc unit/calib/pair_change_test.cc unit/calib/stereo/pair_captures_test.cc unit/calib/stereo/models_test.cc unit/calib/stereo/moved_pair_test.cc unit/calib/stereo/symmetry_test.cc unit/calib/camera/camera_test.cc
  DEPS calib_virtual rigcal_calib rigcal_sim)
rigcal_test(calib_lens_choice_test COMPUTES
  SOURCES unit/calib/camera/lens_choice_test.cc unit/calib/lens_trial_test.cc
  DEPS calib_virtual rigcal_calib rigcal_sim)
rigcal_test(calib_given_intrinsics_test COMPUTES
  SOURCES unit/calib/camera/given_intrinsics_test.cc
  DEPS calib_virtual rigcal_calib rigcal_sim)
rigcal_test(calib_statistics_test COMPUTES WHOLE
  SOURCES unit/calib/stereo/statistics_test.cc
  DEPS calib_virtual rigcal_calib rigcal_sim)
rigcal_test(calib_real_test COMPUTES
  SOURCES unit/calib/stereo/real_test.cc unit/calib/camera/fisheye_real_test.cc unit/calib/stereo/wide_real_test.cc
  DEPS rigcal_calib rigcal_detect)
rigcal_test(calib_circles_test COMPUTES
  SOURCES unit/calib/stereo/circles_test.cc
  DEPS detect_drawn rigcal_calib rigcal_detect)
rigcal_program(stereo_measure
  SOURCES bench/pairs/stereo_measure.cc bench/pairs/stereo_pictures.cc
  DEPS rigcal_calib rigcal_detect)
rigcal_test(calib_lidar_camera_test COMPUTES
  SOURCES unit/calib/lidar_camera_test.cc unit/calib/one_plane_test.cc unit/calib/plane_moments_test.cc
  DEPS calib_virtual rigcal_calib)
rigcal_program(lidar_camera_measure
  SOURCES bench/pairs/lidar_camera_measure.cc
  DEPS rigcal_calib rigcal_detect rigcal_formats)
rigcal_program(hand_eye_measure
  SOURCES bench/pairs/hand_eye_measure.cc
  DEPS rigcal_calib rigcal_detect rigcal_formats)
rigcal_test(calib_lidar_lidar_test COMPUTES
  SOURCES unit/calib/lidar_lidar_test.cc unit/calib/lidar_lidar_statistics_test.cc
  DEPS calib_virtual rigcal_calib TBB::tbb)
rigcal_program(lidar_lidar_measure
  SOURCES bench/pairs/lidar_lidar_measure.cc
  DEPS rigcal_calib rigcal_formats TBB::tbb)
rigcal_program(lidar_lidar_room
  SOURCES bench/pairs/lidar_lidar_room.cc
  DEPS calib_virtual rigcal_calib)
rigcal_program(hand_eye_simulation
  SOURCES bench/pairs/hand_eye_simulation.cc
  DEPS calib_virtual rigcal_calib)
rigcal_test(calib_hand_eye_test COMPUTES
  SOURCES unit/calib/hand_eye_test.cc unit/calib/hand_eye_statistics_test.cc unit/calib/board_scale_test.cc
          unit/calib/local_path_test.cc
  DEPS calib_virtual rigcal_calib)
rigcal_test(calib_eye_to_hand_test COMPUTES
  SOURCES unit/calib/eye_to_hand_test.cc
  DEPS calib_virtual rigcal_calib)
rigcal_test(calib_eye_to_hand_real_test COMPUTES
  SOURCES unit/calib/eye_to_hand_real_test.cc
  DEPS rigcal_calib rigcal_detect rigcal_formats)
target_compile_definitions(calib_eye_to_hand_real_test PRIVATE RIGCAL_PYTHON="${Python3_EXECUTABLE}")
rigcal_program(eye_to_hand_simulation
  SOURCES bench/pairs/eye_to_hand_simulation.cc
  DEPS calib_virtual rigcal_calib)
rigcal_test(calib_tracker_lidar_test COMPUTES
  SOURCES unit/calib/tracker_lidar_test.cc
  DEPS calib_virtual rigcal_calib)
