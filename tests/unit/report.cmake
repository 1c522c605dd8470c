rigcal_test(report_test
  SOURCES unit/report/revision_test.cc unit/report/large_report_test.cc unit/report/first_screen_test.cc unit/report/fleet_test.cc unit/report/hostile_text_test.cc
          unit/report/graph_svg_test.cc unit/report/text_test.cc unit/report/changes_test.cc
          unit/report/insight_test.cc unit/report/figures_test.cc
          unit/report/cameras_test.cc unit/report/field_maps_test.cc unit/report/lenses_test.cc unit/report/certificate_test.cc unit/report/certificate/figures_test.cc unit/report/certificate/content_test.cc unit/report/past_test.cc unit/report/part_test.cc unit/report/causes_test.cc unit/report/folds_test.cc unit/report/as_found_test.cc unit/report/work_lists_test.cc unit/report/fleet_columns_test.cc
          unit/report/sigma_scale_test.cc unit/report/models_test.cc
  DEPS rigcal_report)
rigcal_unite(report_test)
