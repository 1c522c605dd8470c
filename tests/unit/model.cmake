rigcal_test(model_test
  SOURCES unit/model_uncertainty_test.cc unit/model_edge_id_test.cc unit/model_edge_validate_test.cc
          unit/model_session_test.cc unit/model_manifest_test.cc
          unit/model_unit_doubt_test.cc unit/model_admission_test.cc unit/model_validity_test.cc unit/model_fleet_list_test.cc unit/model_policy_test.cc unit/model_decision_test.cc unit/model_drive_rule_test.cc unit/model_measured_part_test.cc unit/model/board_measure_test.cc
  DEPS rigcal_model)
rigcal_test(model_robot_status_test SOURCES unit/model/robot_status_test.cc DEPS rigcal_model)
