# Runs when cpack has made its packages: each is made anew of its files by dpkg-deb, in order, of root and of one time, so
# that two builds give the same bytes. The time: SOURCE_DATE_EPOCH, else the commit's, else the changelog's.
# A library is told to ldconfig by a trigger, as Debian does; cpack's scripts would call it.
find_program(dpkg_deb dpkg-deb REQUIRED)
set(epoch $ENV{SOURCE_DATE_EPOCH})
if(NOT epoch)
  execute_process(COMMAND git -C ${CMAKE_CURRENT_LIST_DIR} log -1 --format=%ct OUTPUT_VARIABLE epoch OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT epoch)
  set(epoch 1767225600)
endif()
foreach(package ${CPACK_PACKAGE_FILES})
  set(files ${package}.files)
  file(REMOVE_RECURSE ${files})
  execute_process(COMMAND ${dpkg_deb} --raw-extract ${package} ${files} COMMAND_ERROR_IS_FATAL ANY)
  if(EXISTS ${files}/DEBIAN/shlibs)
    file(REMOVE ${files}/DEBIAN/postinst ${files}/DEBIAN/postrm)
    file(WRITE ${files}/DEBIAN/triggers "activate-noawait ldconfig\n")
  endif()
  execute_process(COMMAND find ${files} -exec touch --no-dereference --date=@${epoch} {} + COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env SOURCE_DATE_EPOCH=${epoch} ${dpkg_deb} --root-owner-group -Zxz --build ${files} ${package}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE_RECURSE ${files})
endforeach()
