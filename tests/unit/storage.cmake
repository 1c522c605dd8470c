rigcal_test(storage_test
  SOURCES unit/storage_store_test.cc unit/storage_robot_names_test.cc unit/storage_append_only_test.cc unit/storage_sessions_test.cc unit/storage_standing_test.cc unit/storage_retired_test.cc unit/storage_revision_poses_test.cc unit/storage_merged_edges_test.cc unit/storage_query_plan_test.cc unit/storage_revision_document_test.cc unit/storage_pages_test.cc unit/storage_robot_summary_test.cc unit/storage_fleet_list_test.cc unit/storage_work_lists_test.cc unit/storage_policies_test.cc unit/storage_audit_test.cc unit/storage_decisions_test.cc unit/storage_robot_runs_test.cc unit/storage_as_found_test.cc
          unit/storage_edges_test.cc unit/storage_work_test.cc unit/storage_attempts_test.cc unit/storage_blobs_test.cc unit/storage_lost_blobs_test.cc unit/storage_speed_test.cc unit/storage/epochs_test.cc unit/storage/boards_test.cc
  DEPS rigcal_storage)
rigcal_test(storage_alerts_test SOURCES unit/storage/outbox_test.cc DEPS rigcal_storage)
