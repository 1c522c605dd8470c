# Real processes, real DDS on loopback, a real database: client and server as a technician runs them.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
foreach(flow edges names models public_url completion moved_within full_disk full_disk_batch two_servers validity insight session hand_eye tracker_lidar lidar_pair bin_layout lost_file remount weekly standing approval boards alerts export refusals bad_inputs report_again poison install check import)
  add_test(NAME e2e.${flow} COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/e2e/${flow}_test.py)
  set_tests_properties(e2e.${flow} PROPERTIES LABELS e2e TIMEOUT 600 SKIP_RETURN_CODE 77
    ENVIRONMENT "RIGCAL_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};PYTHONDONTWRITEBYTECODE=1;RIGCAL_BUILD=${PROJECT_BINARY_DIR}")
endforeach()
set_tests_properties(e2e.bad_inputs PROPERTIES COST 80)  # the longest begins first, also where none was ever run

# What a hostile program in the network may send: see bad_inputs.py.
rigcal_program(hostile_client SOURCES e2e/hostile_client.cc DEPS rigcal_client rigcal_dds GTest::gtest)
