rigcal_test(sites_test SOURCES unit/sites/centre_link_test.cc unit/sites/forwarder_test.cc unit/sites/send_test.cc unit/sites/take_over_test.cc unit/storage/engines.cc DEPS rigcal_sites rigcal_http)
# With an S3 server; left out where there is none.
add_test(NAME sites_test_s3 COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/s3/with_s3 $<TARGET_FILE:sites_test> --gtest_filter=SendFromBucketTest.*)
set_tests_properties(sites_test_s3 PROPERTIES TIMEOUT 300 LABELS unit COST 60 SKIP_RETURN_CODE 77)
