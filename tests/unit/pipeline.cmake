rigcal_test(pipeline_test
  SOURCES unit/pipeline_step_test.cc unit/pipeline_answer_test.cc unit/pipeline_names_test.cc unit/pipeline_orders_test.cc unit/pipeline_clouds_test.cc unit/pipeline_parameters_test.cc unit/pipeline_cameras_test.cc unit/pipeline_lidar_test.cc unit/calib_virtual_room.cc unit/pipeline_live_test.cc unit/pipeline_fleet_test.cc
          unit/pipeline_worker_pool_test.cc unit/pipeline_merged_history_test.cc unit/pipeline_merged_sessions_test.cc unit/pipeline_whole_revision_test.cc unit/pipeline_pages_test.cc unit/pipeline_missing_report_test.cc unit/pipeline_health_test.cc unit/pipeline_attempts_test.cc unit/pipeline_retention_test.cc unit/pipeline_turns_test.cc unit/pipeline_validity_test.cc unit/pipeline_lost_file_test.cc
  DEPS rigcal_pipeline)
