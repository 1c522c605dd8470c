rigcal_test(base_test
  SOURCES unit/base/result_test.cc unit/base/ids_test.cc unit/base/stamp_test.cc unit/base/file_test.cc
          unit/base/log_test.cc unit/base/base64_test.cc unit/base/vitals_test.cc unit/base/memory_budget_test.cc
          unit/base/last_run_test.cc unit/base/password_test.cc unit/base/near_names_test.cc unit/base/private_files_test.cc unit/base/guarded_test.cc unit/base/service_manager_test.cc unit/base/site_robots_test.cc
  DEPS rigcal_base)
