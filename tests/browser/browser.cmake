# Pages in a real browser, from a real server. Skips, saying so, without chromium. A browser is many
# processes that draw without a graphics card: beside another test on two cores it waits longer than a page may.
foreach(flow pages cloud companion login)
  add_test(NAME browser.${flow} COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/browser/${flow}_test.py)
  set_tests_properties(browser.${flow} PROPERTIES LABELS browser TIMEOUT 600 SKIP_RETURN_CODE 77 RESOURCE_LOCK browser PROCESSORS 2
    ENVIRONMENT "RIGCAL_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY};PYTHONDONTWRITEBYTECODE=1;NODE_PATH=${RIGCAL_NODE_MODULES}")
endforeach()
set_tests_properties(browser.pages PROPERTIES COST 40)
# Need no browser, only node, which the build needs too.
foreach(script sigma_scale trend_text)
  add_test(NAME browser.${script} COMMAND ${RIGCAL_NODE} ${PROJECT_SOURCE_DIR}/tests/browser/${script}_test.cjs)
  set_tests_properties(browser.${script} PROPERTIES LABELS browser TIMEOUT 60)
endforeach()
