rigcal_test(model_test
  SOURCES unit/model/uncertainty_test.cc unit/model/edge_id_test.cc unit/model/edge_validate_test.cc
          unit/model/session_test.cc unit/model/manifest_test.cc
          unit/model/unit_doubt_test.cc unit/model/admission_test.cc unit/model/validity_test.cc unit/model/fleet_list_test.cc unit/model/calibration_series_test.cc unit/model/policy_test.cc unit/model/decision_test.cc unit/model/drive_rule_test.cc unit/model/measured_part_test.cc unit/model/board_measure_test.cc unit/model/circle_target_test.cc unit/model/visit_scatter_test.cc unit/model/given_pose_test.cc
  DEPS rigcal_model)
rigcal_unite(model_test)
rigcal_test(model_robot_status_test SOURCES unit/model/robot_status_test.cc DEPS rigcal_model)
rigcal_test(model_mounted_target_test SOURCES unit/model/mounted_target_test.cc DEPS rigcal_model)
