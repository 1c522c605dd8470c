find_package(Python3 REQUIRED COMPONENTS Interpreter)
foreach(name include_table function_size words limits_table version house ids library metrics glossary schema format walk)
  add_test(NAME hygiene.${name}
    COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/${name}_test.py
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(hygiene.${name} PROPERTIES TIMEOUT 120 LABELS hygiene)
endforeach()
add_test(NAME hygiene.sbom COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/sbom_test.py)
set_tests_properties(hygiene.sbom PROPERTIES TIMEOUT 300 LABELS hygiene ENVIRONMENT "RIGCAL_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
