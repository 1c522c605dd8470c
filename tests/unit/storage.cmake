rigcal_test(storage_test
  SOURCES unit/storage/engines.cc unit/storage/store_test.cc unit/storage/robot_names_test.cc unit/storage/append_only_test.cc unit/storage/full_store.cc unit/storage/sessions_test.cc unit/storage/standing_test.cc unit/storage/retired_test.cc unit/storage/revisions/revision_poses_test.cc unit/storage/revisions/merged_edges_test.cc unit/storage/query_plan_test.cc unit/storage/revisions/revision_document_test.cc unit/storage/pages_test.cc unit/storage/fleet/robot_summary_test.cc unit/storage/fleet/fleet_list_test.cc unit/storage/fleet/fleet_columns_test.cc unit/storage/fleet/calibration_series_test.cc unit/storage/fleet/work_lists_test.cc unit/storage/policies_test.cc unit/storage/audit_test.cc unit/storage/held_content_test.cc unit/storage/revisions/decisions_test.cc unit/storage/fleet/robot_runs_test.cc unit/storage/revisions/as_found_test.cc
          unit/storage/edges_test.cc unit/storage/work_test.cc unit/storage/attempts_test.cc unit/storage/blobs_test.cc unit/storage/lost_blobs_test.cc unit/storage/speed_test.cc unit/storage/epochs_test.cc unit/storage/boards_test.cc unit/storage/recomputations_test.cc unit/storage/visit_scatter_test.cc unit/storage/model_visits_test.cc unit/storage/access_test.cc unit/storage/postgres_schema_test.cc unit/storage/postgres_store_test.cc unit/storage/leases_test.cc unit/storage/servers_test.cc
  DEPS rigcal_storage)
rigcal_unite(storage_test)
rigcal_test(storage_alerts_test SOURCES unit/storage/engines.cc unit/storage/outbox_test.cc unit/storage/sites_test.cc DEPS rigcal_storage)
rigcal_test(move_test
  SOURCES unit/storage/engines.cc unit/storage/full_store.cc unit/move/fixture.cc unit/move/move_store_test.cc unit/move/broken_off_test.cc
  DEPS rigcal_move SQLiteCpp)
rigcal_test(storage_bucket_test
  SOURCES unit/storage/engines.cc unit/storage/s3/bucket_place_test.cc unit/storage/s3/bucket_test.cc unit/storage/s3/store_bucket_test.cc
  DEPS rigcal_storage)
# Those that need an S3 server, with one; left out where there is none.
add_test(NAME storage_bucket_test_s3 COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/s3/with_s3 $<TARGET_FILE:storage_bucket_test>)
add_test(NAME storage_bucket_test_s3_postgres
  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/s3/with_s3 ${CMAKE_CURRENT_SOURCE_DIR}/postgres/with_postgres $<TARGET_FILE:storage_bucket_test>)
set_tests_properties(storage_bucket_test_s3 storage_bucket_test_s3_postgres PROPERTIES TIMEOUT 300 LABELS unit COST 60 SKIP_RETURN_CODE 77)
# The same tests on PostgreSQL; left out where it is not installed.
foreach(name storage_test storage_alerts_test move_test upkeep_server_test)
  add_test(NAME ${name}_postgres COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/postgres/with_postgres $<TARGET_FILE:${name}>)
  set_tests_properties(${name}_postgres PROPERTIES TIMEOUT 1200 LABELS unit COST 60 SKIP_RETURN_CODE 77)
endforeach()
