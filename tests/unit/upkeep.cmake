rigcal_test(upkeep_test
  SOURCES unit/upkeep/backup_test.cc unit/upkeep/restore_backup_test.cc unit/upkeep/fsck_test.cc unit/upkeep/page_sums_test.cc unit/upkeep/log_damage_test.cc unit/upkeep/log_guard_test.cc unit/upkeep/refused_pages_test.cc
  DEPS rigcal_upkeep SQLiteCpp)
rigcal_test(upkeep_server_test
  SOURCES unit/storage/engines.cc unit/upkeep/fsck_server_test.cc
  DEPS rigcal_upkeep SQLiteCpp)
