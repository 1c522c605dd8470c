rigcal_test(idl_test
  SOURCES unit/idl_convert_test.cc unit/idl_calibration_test.cc unit/idl_endpoint_test.cc unit/idl_golden_test.cc unit/idl_presence_test.cc
  DEPS rigcal_idl rigcal_model)
