rigcal_test(process_test SOURCES unit/process/settings_test.cc unit/process/identity_watch_test.cc DEPS rigcal_process rigcal_identity)
