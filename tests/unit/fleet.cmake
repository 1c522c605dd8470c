rigcal_test(fleet_test SOURCES unit/fleet_assess_test.cc unit/fleet_refined_test.cc unit/fleet_trust_test.cc unit/fleet_suspects_test.cc DEPS rigcal_fleet)
