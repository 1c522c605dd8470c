rigcal_test(client_text_test
  SOURCES unit/client_table_test.cc unit/client_progress_test.cc unit/client_document_test.cc
          unit/client_pose_text_test.cc unit/client_checks_test.cc unit/client_reply_parts_test.cc
          unit/client_edge_table_test.cc unit/client_cause_list_test.cc unit/client_insight_table_test.cc unit/client_compare_test.cc unit/client/may_leave_test.cc
  DEPS rigcal_client)
rigcal_test(client_push_test
  SOURCES unit/client_push_engine_test.cc unit/client_push_property_test.cc unit/client_file_pieces_test.cc
          unit/client_edge_batch_test.cc
  DEPS rigcal_client)
rigcal_test(client_wire_test
  SOURCES unit/client_connection_test.cc unit/client_one_server_test.cc unit/client_transfer_test.cc unit/client_verbs_test.cc unit/client_standing_test.cc unit/client_history_test.cc unit/client_audit_test.cc unit/client_decide_test.cc unit/client_agent_file_test.cc
          unit/client_exit_code_test.cc unit/client_policy_test.cc unit/client_unit_doubt_test.cc unit/client_completion_test.cc unit/client_part_text_test.cc unit/client/models_test.cc unit/client/board_verb_test.cc
  DEPS rigcal_client)
rigcal_test(client_program_test
  SOURCES unit/client_program_test.cc
  DEPS rigcal_client)
target_compile_definitions(client_program_test PRIVATE RIGCAL_PROGRAM="$<TARGET_FILE:rigcal>")
add_dependencies(client_program_test rigcal)
