rigcal_test(base_test
  SOURCES unit/base_result_test.cc unit/base_ids_test.cc unit/base_stamp_test.cc unit/base_file_test.cc
          unit/base_log_test.cc unit/base_base64_test.cc unit/base_vitals_test.cc unit/base_memory_budget_test.cc
          unit/base_last_run_test.cc unit/base_near_names_test.cc
  DEPS rigcal_base)
