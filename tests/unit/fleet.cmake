rigcal_test(fleet_test SOURCES unit/fleet/assess_test.cc unit/fleet/weak_pair_notes_test.cc unit/fleet/not_needed_test.cc unit/fleet/barren_visit_test.cc unit/fleet/refined_test.cc unit/fleet/wrong_intrinsics_test.cc unit/fleet/unseen_moves_test.cc unit/fleet/apart_test.cc unit/fleet/trust_test.cc unit/fleet/suspects_test.cc unit/fleet/effect_test.cc unit/fleet/rig_causes_test.cc unit/fleet/board_remarks_test.cc unit/fleet/verdict_keys_test.cc unit/fleet/verdict_basis_test.cc DEPS rigcal_fleet)
rigcal_unite(fleet_test)
rigcal_test(fleet_visits_test COMPUTES SOURCES unit/fleet/third_visit_test.cc unit/fleet/weak_edge_test.cc DEPS rigcal_fleet rigcal_graph)
rigcal_test(fleet_causes_test COMPUTES
  SOURCES unit/fleet/causes/board_size_test.cc unit/fleet/causes/causes_test.cc unit/fleet/causes/exchanged_test.cc unit/fleet/causes/files_test.cc unit/fleet/causes/moved_pairs_test.cc
          unit/fleet/causes/places_test.cc unit/fleet/causes/told_causes_test.cc unit/fleet/causes/visit.cc
  DEPS calib_virtual rigcal_fleet rigcal_calib rigcal_sim)
rigcal_test(fleet_as_found_test COMPUTES SOURCES unit/fleet/as_found_test.cc unit/fleet/partly_known_test.cc unit/fleet/drift_rate_test.cc unit/fleet/smallest_change_test.cc DEPS rigcal_fleet)
rigcal_test(fleet_population_test COMPUTES SOURCES unit/fleet/population_test.cc unit/fleet/scatter_pool_test.cc DEPS rigcal_fleet)
rigcal_test(fleet_status_test COMPUTES SOURCES unit/fleet/drift_forecast_test.cc unit/fleet/sensor_status_test.cc DEPS rigcal_fleet)
