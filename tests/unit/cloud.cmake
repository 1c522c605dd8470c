rigcal_test(cloud_test COMPUTES
  SOURCES unit/cloud/lens_test.cc unit/cloud/colour_test.cc unit/cloud/files_test.cc unit/cloud/pictures_test.cc
  DEPS rigcal_cloud rigcal_calib rigcal_formats)
