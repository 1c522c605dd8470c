rigcal_test(http_test
  SOURCES unit/http_server_test.cc unit/http_static_test.cc unit/http_robust_test.cc unit/http_path_test.cc unit/http_public_address_test.cc
  DEPS rigcal_http)
