rigcal_test(pipeline_test
  SOURCES unit/pipeline_step_test.cc unit/pipeline_answer_test.cc unit/pipeline_clouds_test.cc unit/pipeline_parameters_test.cc unit/pipeline_cameras_test.cc unit/pipeline_lidar_test.cc unit/pipeline_lost_file_test.cc unit/calib_virtual_room.cc unit/pipeline_live_test.cc unit/pipeline_fleet_test.cc
  DEPS rigcal_pipeline)
