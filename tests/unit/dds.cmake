rigcal_test(dds_test
  SOURCES unit/dds/byte_ranges_test.cc unit/dds/part_file_test.cc unit/dds/open_sessions_test.cc unit/dds/inbox_test.cc unit/dds/from_idl_test.cc
          unit/dds/session_test.cc unit/dds/resume_test.cc unit/dds/lost_file_test.cc unit/dds/superseded_there_test.cc unit/dds/batch_test.cc unit/dds/request_test.cc unit/dds/answerers_test.cc unit/storage/engines.cc
          unit/dds/announce_test.cc unit/dds/outbox_test.cc unit/dds/limits_test.cc unit/dds/only_server_test.cc unit/dds/figures_test.cc unit/dds/receipt_watches_test.cc
  DEPS rigcal_dds)
rigcal_unite(dds_test)
