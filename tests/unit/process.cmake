rigcal_test(process_test SOURCES unit/process/settings_test.cc DEPS rigcal_process)
