rigcal_test(calib_placement_test COMPUTES
  SOURCES unit/calib/placement/placement_test.cc
  DEPS rigcal_calib)
rigcal_test(companion_test COMPUTES
  SOURCES unit/client/companion/companion_test.cc bench/companion/held_board.cc
  DEPS rigcal_companion rigcal_sim)
