# Runs at install time, when the prefix is known: settings, units, what the package is made of. file(INSTALL) obeys DESTDIR.
cmake_path(ABSOLUTE_PATH CMAKE_INSTALL_PREFIX NORMALIZE OUTPUT_VARIABLE prefix)
if(prefix STREQUAL "/usr")
  set(settings /etc/rigcal)
  set(units /lib/systemd/system)
else()
  set(settings ${prefix}/etc/rigcal)
  set(units ${prefix}/lib/systemd/system)
  file(INSTALL ${rigcal_sources}/../LICENSE DESTINATION ${prefix}/share/doc/rigcal)  # Debian has it already
endif()

foreach(name rigcald.service rigcal-worker@.service packaging/rigcald.env packaging/rigcald.conf packaging/worker.env packaging/limits.yaml)
  file(READ ${rigcal_sources}/${name} text)
  string(REPLACE "/usr/" "${prefix}/" text "${text}")
  string(REPLACE "/etc/rigcal" "${settings}" text "${text}")
  get_filename_component(file ${name} NAME)
  file(WRITE ${rigcal_staging}/${file} "${text}")
endforeach()

# What the package is made of, as of the commit; of sources without one, of the day in the changelog.
set(epoch $ENV{SOURCE_DATE_EPOCH})
if(NOT epoch)
  execute_process(COMMAND git -C ${rigcal_sources} log -1 --format=%ct OUTPUT_VARIABLE epoch OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT epoch)
  set(epoch 1767225600)
endif()
execute_process(COMMAND ${rigcal_python} -B ${rigcal_sources}/packaging/sbom.py --version ${rigcal_version} --epoch ${epoch}
  --packages ${rigcal_sources}/packages.txt --lock ${rigcal_sources}/../web-static/package-lock.json
  --output ${rigcal_staging}/rigcal.spdx.json ${rigcal_programs} COMMAND_ERROR_IS_FATAL ANY)

set(mode OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
file(INSTALL ${rigcal_staging}/rigcald.service ${rigcal_staging}/rigcal-worker@.service DESTINATION ${units} PERMISSIONS ${mode})
file(INSTALL ${rigcal_staging}/rigcald.env ${rigcal_staging}/rigcald.conf ${rigcal_staging}/worker.env ${rigcal_staging}/limits.yaml DESTINATION ${settings} PERMISSIONS ${mode})
file(INSTALL ${rigcal_staging}/rigcal.spdx.json DESTINATION ${prefix}/share/doc/rigcal PERMISSIONS ${mode})
