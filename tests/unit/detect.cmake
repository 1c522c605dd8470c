rigcal_test(detect_test COMPUTES
  SOURCES unit/detect_header_test.cc unit/detect_board_test.cc unit/detect_search_test.cc unit/detect_charuco_test.cc unit/detect_rendering.cc
          unit/detect_symmetric_test.cc unit/detect_tag_grid_test.cc unit/detect_real_test.cc unit/detect_strays_test.cc unit/detect_large_test.cc
  DEPS rigcal_detect)
rigcal_test(detect_cloud_test COMPUTES
  SOURCES unit/detect_cloud_real_test.cc unit/detect_cloud_simulated_test.cc
    unit/detect_cloud_degenerate_test.cc
  DEPS rigcal_detect)

# Takes its pictures out of videos by itself, with ffmpeg.
rigcal_test(detect_caliscope_test COMPUTES SOURCES unit/detect_caliscope_test.cc DEPS rigcal_detect rigcal_formats)
target_compile_definitions(detect_caliscope_test PRIVATE RIGCAL_PYTHON="${Python3_EXECUTABLE}")
