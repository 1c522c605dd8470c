rigcal_test(dds_fault_test
  SOURCES fault/dds_fault_test.cc
  DEPS rigcal_dds ${CMAKE_DL_LIBS}
  LABELS fault)
rigcal_test(storage_fault_test
  SOURCES fault/fault_disk.cc fault/storage_fault_test.cc fault/storage_kill_test.cc
  DEPS rigcal_storage
  LABELS fault)

# Preloaded into programs: see disk_recorder.cc.
add_library(rigcal_disk_recorder MODULE fault/disk_log.cc fault/planned_failure.cc fault/disk_recorder.cc fault/told_by_dds.cc)
rigcal_settings(rigcal_disk_recorder)
target_link_libraries(rigcal_disk_recorder PRIVATE ${CMAKE_DL_LIBS})
# Of DDS the headers alone: what a program without it would otherwise have to load.
target_include_directories(rigcal_disk_recorder SYSTEM PRIVATE ${PROJECT_BINARY_DIR}/idl
  $<TARGET_PROPERTY:CycloneDDS::ddsc,INTERFACE_INCLUDE_DIRECTORIES>)
add_dependencies(rigcal_disk_recorder rigcal_idl)
set_target_properties(rigcal_disk_recorder PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
# Likewise: see failing_memory.cc.
add_library(rigcal_failing_memory MODULE fault/planned_failure.cc fault/failing_memory.cc)
rigcal_settings(rigcal_failing_memory)
target_link_libraries(rigcal_failing_memory PRIVATE ${CMAKE_DL_LIBS})
set_target_properties(rigcal_failing_memory PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
# Run with it: see durable_files.cc.
rigcal_program(durable_files SOURCES fault/durable_files.cc DEPS rigcal_storage rigcal_bags rigcal_import ${CMAKE_DL_LIBS})
# With neither sanitizer: a library that is preloaded comes before theirs.
if(NOT RIGCAL_SANITIZE)
  foreach(name power_loss nth_failure no_memory)
    add_test(NAME fault.${name} COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/fault/${name}_test.py)
    set_tests_properties(fault.${name} PROPERTIES LABELS fault TIMEOUT 600 SKIP_RETURN_CODE 77 COST 60
      ENVIRONMENT "RIGCAL_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};PYTHONDONTWRITEBYTECODE=1")
  endforeach()
endif()
