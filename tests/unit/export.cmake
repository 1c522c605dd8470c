# Readers of the files that leave which are not ours: urdfdom, OpenCV, yaml-cpp, nlohmann-json. Nothing of the product uses urdfdom.
pkg_check_modules(URDFDOM REQUIRED IMPORTED_TARGET urdfdom)
rigcal_test(formats_export_test
  SOURCES unit/formats/export_ros_test.cc unit/formats/export_camera_tools_test.cc unit/formats/export_calibration_test.cc
  DEPS rigcal_export ${OpenCV_LIBS} PkgConfig::URDFDOM)
rigcal_test(formats_rig_files_test
  SOURCES unit/formats/rig_files_test.cc unit/formats/urdf_patch_test.cc
  DEPS rigcal_export rigcal_rig_files PkgConfig::URDFDOM)
