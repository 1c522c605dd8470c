rigcal_test(fleet_test SOURCES unit/fleet_assess_test.cc DEPS rigcal_fleet)
