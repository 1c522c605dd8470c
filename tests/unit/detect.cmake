rigcal_test(detect_test COMPUTES
  SOURCES unit/detect_header_test.cc unit/detect_board_test.cc unit/detect_search_test.cc unit/detect_charuco_test.cc unit/detect_rendering.cc
          unit/detect_symmetric_test.cc unit/detect_tag_grid_test.cc unit/detect_real_test.cc unit/detect_strays_test.cc unit/detect_large_test.cc
  DEPS rigcal_detect)
rigcal_test(detect_cloud_test COMPUTES
  SOURCES unit/detect_cloud_real_test.cc unit/detect_cloud_simulated_test.cc
    unit/detect_cloud_degenerate_test.cc
  DEPS rigcal_detect)

# Real pictures of a ChArUco board, out of videos that lie beside the project: extracted once a run, where they are.
set(RIGCAL_CALISCOPE ${PROJECT_SOURCE_DIR}/../shared/data/multicam_caliscope/4_cam_recording)
set(RIGCAL_CALISCOPE_SESSION ${CMAKE_BINARY_DIR}/data/caliscope)
add_executable(detect_caliscope_test unit/detect_caliscope_test.cc)
target_link_libraries(detect_caliscope_test PRIVATE rigcal_detect rigcal_formats GTest::gmock_main)
rigcal_settings(detect_caliscope_test)
rigcal_precompile(detect_caliscope_test FROM rigcal_computing_test_pch)
target_compile_definitions(detect_caliscope_test PRIVATE RIGCAL_CALISCOPE="${RIGCAL_CALISCOPE}"
                           RIGCAL_CALISCOPE_SESSION="${RIGCAL_CALISCOPE_SESSION}")
add_test(NAME detect_caliscope_test COMMAND detect_caliscope_test)
set_tests_properties(detect_caliscope_test PROPERTIES TIMEOUT 300 LABELS unit SKIP_REGULAR_EXPRESSION "SKIPPED")
find_program(FFMPEG ffmpeg)
if(FFMPEG AND EXISTS ${RIGCAL_CALISCOPE})
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  add_test(NAME extract_caliscope
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/data/extract_caliscope.py ${RIGCAL_CALISCOPE}
            ${RIGCAL_CALISCOPE_SESSION})
  set_tests_properties(extract_caliscope PROPERTIES TIMEOUT 300 LABELS unit FIXTURES_SETUP caliscope)
  set_tests_properties(detect_caliscope_test PROPERTIES FIXTURES_REQUIRED caliscope)
endif()
