rigcal_test(client_text_test
  SOURCES unit/client/text/table_test.cc unit/client/text/progress_test.cc unit/client/text/document_test.cc
          unit/client/text/pose_text_test.cc unit/client/checks_test.cc unit/client/wire/reply_parts_test.cc
          unit/client/text/edge_table_test.cc unit/client/text/cause_list_test.cc unit/client/text/insight_table_test.cc unit/client/compare_test.cc unit/client/may_leave_test.cc
  DEPS rigcal_client)
rigcal_test(client_push_test
  SOURCES unit/client/wire/push_engine_test.cc unit/client/wire/push_property_test.cc unit/client/wire/file_pieces_test.cc
          unit/client/wire/edge_batch_test.cc
  DEPS rigcal_client)
rigcal_test(client_wire_test
  SOURCES unit/client/wire/connection_test.cc unit/client/wire/one_server_test.cc unit/client/wire/transfer_test.cc unit/client/verbs_test.cc unit/client/due_test.cc unit/client/help_test.cc unit/client/standing_test.cc unit/client/history_test.cc unit/client/audit_test.cc unit/client/decide_test.cc unit/client/agent_file_test.cc
          unit/client/exit_code_test.cc unit/client/policy_test.cc unit/client/unit_doubt_test.cc unit/client/completion_test.cc unit/client/bag_path_test.cc unit/client/text/part_text_test.cc unit/client/models_test.cc unit/client/board_verb_test.cc unit/client/resolve_test.cc unit/client/report_test.cc
  DEPS rigcal_client)
rigcal_unite(client_wire_test)
rigcal_test(client_program_test
  SOURCES unit/client/program_test.cc
  DEPS rigcal_client)
rigcal_test(client_certificate_test SOURCES unit/client/certificate/paper_test.cc DEPS rigcal_certificate)
rigcal_test(client_ros_test
  SOURCES unit/client/ros/messages_test.cc unit/client/ros/wire_test.cc unit/client/ros/cdr_topic_test.cc unit/client/ros/tf_test.cc
  DEPS rigcal_client rigcal_bags)
target_compile_definitions(client_program_test PRIVATE RIGCAL_PROGRAM="$<TARGET_FILE:rigcal>")
add_dependencies(client_program_test rigcal)
rigcal_test(client_library_test SOURCES unit/client/library/values_test.cc DEPS rigcal_shared Eigen3::Eigen)
rigcal_test(client_redact_test SOURCES unit/client/upkeep/redact_test.cc DEPS rigcal_client)
target_sources(client_redact_test PRIVATE ${PROJECT_SOURCE_DIR}/client/upkeep/support/redact.cc)
