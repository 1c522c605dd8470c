rigcal_test(dds_fault_test
  SOURCES fault/dds_fault_test.cc
  DEPS rigcal_dds ${CMAKE_DL_LIBS}
  LABELS fault)
rigcal_test(storage_fault_test
  SOURCES fault/fault_disk.cc fault/storage_fault_test.cc fault/storage_kill_test.cc
  DEPS rigcal_storage
  LABELS fault)
