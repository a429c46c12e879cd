# Run after a test program is linked: writes SCRIPT for ctest, an entry for each suite of PROGRAM (its tests run in one process).
# Wants PROGRAM, SCRIPT, LABELS, TIMEOUT.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY TIMEOUT 60)
# Suites begin their lines, tests are indented; what comes after # is a parameter.
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${listed}")
set(text "")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "[\n.]" "" suite "${suite}")
  string(APPEND text "add_test([=[${suite}]=] \"${PROGRAM}\" \"--gtest_filter=${suite}.*\")\n"
    "set_tests_properties([=[${suite}]=] PROPERTIES LABELS \"${LABELS}\" TIMEOUT ${TIMEOUT})\n")
endforeach()
if(text STREQUAL "")
  message(FATAL_ERROR "${PROGRAM} has no tests")
endif()
file(WRITE ${SCRIPT} "${text}")
