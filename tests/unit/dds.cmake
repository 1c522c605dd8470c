rigcal_test(dds_test
  SOURCES unit/dds_byte_ranges_test.cc unit/dds_part_file_test.cc unit/dds_inbox_test.cc unit/dds_from_idl_test.cc
          unit/dds_session_test.cc unit/dds_resume_test.cc unit/dds_lost_file_test.cc unit/dds_batch_test.cc unit/dds_request_test.cc unit/dds_answerers_test.cc
          unit/dds_announce_test.cc unit/dds_outbox_test.cc unit/dds_limits_test.cc unit/dds_only_server_test.cc
  DEPS rigcal_dds)
