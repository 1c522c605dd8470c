rigcal_test(check_test
  SOURCES unit/check_words_test.cc unit/check_edge_width_test.cc unit/check_advice_test.cc
  DEPS rigcal_check)
rigcal_test(check_session_test COMPUTES
  SOURCES unit/check_session_test.cc
  DEPS rigcal_check rigcal_sim)
