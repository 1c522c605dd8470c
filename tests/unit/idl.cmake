rigcal_test(idl_test
  SOURCES unit/idl/convert_test.cc unit/idl/calibration_test.cc unit/idl/endpoint_test.cc unit/idl/golden_test.cc unit/idl/presence_test.cc unit/idl/reach_test.cc
  DEPS rigcal_idl rigcal_model)
rigcal_test(security_test
  SOURCES unit/idl/security_test.cc unit/client/identity/authority_test.cc
  DEPS rigcal_identity)
