rigcal_test(record_test
  SOURCES unit/record/arrivals_test.cc unit/record/wanted_topics_test.cc unit/record/bag_file_test.cc unit/record/followed_topic_test.cc unit/record/topic_report_test.cc unit/record/interrupt_test.cc unit/record/player_test.cc
          ${PROJECT_SOURCE_DIR}/client/programs/interrupt.cc
  DEPS rigcal_record)
