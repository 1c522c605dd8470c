rigcal_test(http_test
  SOURCES unit/http/server_test.cc unit/http/static_test.cc unit/http/robust_test.cc unit/http/path_test.cc unit/http/public_address_test.cc unit/http/client_address_test.cc unit/http/allowed_hosts_test.cc unit/http/compressed_test.cc unit/http/served_test.cc unit/http/tls_test.cc unit/http/form_test.cc unit/http/logins_test.cc unit/http/orders_test.cc unit/http/forwarded_test.cc
  DEPS rigcal_http ZLIB::ZLIB OpenSSL::SSL)
