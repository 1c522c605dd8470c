rigcal_test(detect_test
  SOURCES unit/detect_header_test.cc unit/detect_board_test.cc unit/detect_real_test.cc
  DEPS rigcal_detect)
