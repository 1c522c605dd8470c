rigcal_test(moments_test COMPUTES
  SOURCES unit/moments/clock_fit_test.cc unit/moments/sight_test.cc unit/moments/picture_watcher_test.cc unit/moments/choose_test.cc
  DEPS rigcal_moments rigcal_sim)
