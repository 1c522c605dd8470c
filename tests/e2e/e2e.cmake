# Real processes, real DDS on loopback, a real database: client and server as a technician runs them.
# Flows by theme: sensors/ a session to poses, people/ what is decided and told, tools/ what goes in and out beside sessions,
# faults/ disks and processes that fail, hostile/ input that nobody should send. What flows share stands beside this file.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
foreach(flow
    edges
    sensors/any_board sensors/any_order sensors/bin_layout sensors/eye_to_hand sensors/hand_eye sensors/insight sensors/lidar_pair sensors/moved_within
    sensors/session sensors/sphere_lens sensors/tracker_lidar sensors/weekly sensors/wrong_intrinsics
    people/alerts people/approval people/boards people/identities people/logins people/models people/names people/not_needed people/remount people/resolve people/standing
    people/validity
    tools/check tools/companion tools/completion tools/export tools/https tools/import tools/import_stream tools/install tools/library tools/metrics tools/public_url tools/push_bag tools/record tools/reload tools/support
    tools/tf
    faults/backup faults/bucket faults/bucket_workers faults/cluster faults/full_disk faults/full_disk_batch faults/held_files faults/lost_file faults/migrate_store faults/postgres faults/read_only faults/report_again faults/several_servers faults/sites faults/two_servers faults/workers
    hostile/bad_inputs hostile/http_hostile hostile/poison hostile/refusals)
  get_filename_component(name ${flow} NAME)
  add_test(NAME e2e.${name} COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/e2e/${flow}_test.py)
  set_tests_properties(e2e.${name} PROPERTIES LABELS e2e TIMEOUT 600 SKIP_RETURN_CODE 77
    ENVIRONMENT "RIGCAL_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};PYTHONDONTWRITEBYTECODE=1;RIGCAL_BUILD=${PROJECT_BINARY_DIR}")
endforeach()
if(RIGCAL_SANITIZE)
  set_tests_properties(e2e.library PROPERTIES DISABLED TRUE)  # programs that are built without a sanitizer can't load what is
endif()
set_tests_properties(e2e.bad_inputs PROPERTIES COST 80)  # the longest begins first, also where none was ever run

# What a hostile program in the network may send: see hostile/bad_inputs.py.
rigcal_program(hostile_client SOURCES e2e/hostile/hostile_client.cc DEPS rigcal_client rigcal_dds GTest::gtest)

# A program of ROS 2, as far as a topic is concerned: see tools/ros_reader.cc.
rigcal_program(ros_reader SOURCES e2e/tools/ros_reader.cc DEPS rigcal_idl)
