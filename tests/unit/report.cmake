rigcal_test(report_test
  SOURCES unit/report_revision_test.cc unit/report_fleet_test.cc unit/report_hostile_text_test.cc
          unit/report_graph_svg_test.cc unit/report_text_test.cc unit/report_changes_test.cc
          unit/report_insight_test.cc unit/report_figures_test.cc
          unit/report_cameras_test.cc unit/report_field_maps_test.cc unit/report_lenses_test.cc unit/report_certificate_test.cc unit/report_past_test.cc unit/report_part_test.cc unit/report_causes_test.cc unit/report_folds_test.cc unit/report_as_found_test.cc unit/report_work_lists_test.cc
          unit/report/sigma_scale_test.cc unit/report/models_test.cc
  DEPS rigcal_report)
