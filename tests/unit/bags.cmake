rigcal_test(bags_test
  SOURCES unit/bags/mcap_conformance_test.cc unit/bags/recorded_bags_test.cc unit/bags/definition_test.cc unit/bags/decode_test.cc unit/bags/damaged_mcap_test.cc
          unit/bags/messages_test.cc unit/bags/mcap_writer_test.cc unit/bags/parts_test.cc
  DEPS rigcal_bags)
rigcal_test(import_test
  SOURCES unit/import/captures_test.cc unit/import/rig_map_test.cc unit/import/frame_tree_test.cc unit/import/pose_frames_test.cc unit/import/camera_info_test.cc unit/import/files_test.cc
          unit/import/stream_kind_test.cc unit/import/moments_told_test.cc
  DEPS rigcal_import)
