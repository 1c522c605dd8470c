rigcal_test(check_test
  SOURCES unit/client/check/words_test.cc unit/client/check/edge_width_test.cc unit/client/check/advice_test.cc unit/client/check/file_advice_test.cc
  DEPS rigcal_check)
rigcal_test(check_session_test COMPUTES
  SOURCES unit/client/check/session_test.cc
  DEPS rigcal_check rigcal_sim)
