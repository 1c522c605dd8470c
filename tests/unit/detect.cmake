# Pictures of boards, drawn.
rigcal_library(detect_drawn SOURCES unit/detect/circles.cc unit/detect/rendering.cc DEPS rigcal_detect)
rigcal_test(detect_test COMPUTES
  SOURCES unit/detect/header_test.cc unit/detect/board_test.cc unit/detect/search_test.cc unit/detect/charuco_test.cc unit/detect/circle_grid_test.cc unit/detect/circle_perspective_test.cc
          unit/detect/symmetric_test.cc unit/detect/tag_grid_test.cc unit/detect/real_test.cc unit/detect/grid_outliers_test.cc unit/detect/large_test.cc
  DEPS detect_drawn rigcal_detect)
rigcal_test(detect_cloud_test COMPUTES
  SOURCES unit/detect/cloud_real_test.cc unit/detect/cloud_simulated_test.cc
    unit/detect/cloud_degenerate_test.cc
  DEPS rigcal_detect)

# Takes its pictures out of videos by itself, with ffmpeg.
rigcal_test(detect_caliscope_test COMPUTES SOURCES unit/detect/caliscope_test.cc DEPS rigcal_detect rigcal_formats)
target_compile_definitions(detect_caliscope_test PRIVATE RIGCAL_PYTHON="${Python3_EXECUTABLE}")
