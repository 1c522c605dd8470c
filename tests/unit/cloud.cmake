rigcal_test(cloud_test COMPUTES
  SOURCES unit/cloud_lens_test.cc unit/cloud_colour_test.cc unit/cloud_files_test.cc unit/cloud_pictures_test.cc
  DEPS rigcal_cloud rigcal_calib rigcal_formats)
