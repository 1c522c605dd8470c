rigcal_test(fleet_test SOURCES unit/fleet_assess_test.cc unit/fleet_refined_test.cc unit/fleet_trust_test.cc unit/fleet_suspects_test.cc unit/fleet_effect_test.cc unit/fleet/rig_causes_test.cc unit/fleet/board_remarks_test.cc DEPS rigcal_fleet)
rigcal_test(fleet_causes_test COMPUTES
  SOURCES unit/fleet_board_size_test.cc unit/fleet_causes_test.cc unit/fleet_exchanged_test.cc unit/fleet_files_test.cc
          unit/fleet_places_test.cc unit/fleet_told_causes_test.cc unit/fleet_visit.cc unit/calib_virtual_lidar.cc
          unit/calib_virtual_motion.cc unit/calib_virtual_pair.cc
  DEPS rigcal_fleet rigcal_calib)
rigcal_test(fleet_as_found_test COMPUTES SOURCES unit/fleet_as_found_test.cc unit/fleet_drift_rate_test.cc DEPS rigcal_fleet)
rigcal_test(fleet_population_test COMPUTES SOURCES unit/fleet/population_test.cc DEPS rigcal_fleet)
rigcal_test(fleet_status_test COMPUTES SOURCES unit/fleet/drift_forecast_test.cc unit/fleet/sensor_status_test.cc DEPS rigcal_fleet)
