rigcal_test(sites_test SOURCES unit/sites/centre_link_test.cc unit/sites/forwarder_test.cc unit/sites/take_over_test.cc unit/storage/engines.cc DEPS rigcal_sites rigcal_http)
