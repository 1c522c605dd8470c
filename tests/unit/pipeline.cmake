rigcal_test(pipeline_test
  SOURCES unit/pipeline_step_test.cc unit/pipeline_answer_test.cc unit/pipeline_clouds_test.cc unit/pipeline_parameters_test.cc
  DEPS rigcal_pipeline)
