# A test of CMake that checks robot models, for `ctest` and `colcon test`. Copy this file into the package.
#
#   include(cmake/urdfcheck.cmake)
#   urdfcheck_add_test()                                       # all models of the package
#   urdfcheck_add_test(NAME arm PATHS urdf/arm.urdf.xacro OPTIONS --fail-on warning --arg side:=left)
#
# PATHS are relative to the package. The result is a JUnit file below AMENT_TEST_RESULTS_DIR, or below test_results in the
# folder of the build: `colcon test-result` finds both. A test whose urdfcheck is not installed fails; it is not left out.
find_program(URDFCHECK_EXECUTABLE urdfcheck DOC "The command urdfcheck")

function(urdfcheck_add_test)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "NAME;TIMEOUT" "PATHS;OPTIONS")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "urdfcheck_add_test: unknown arguments: ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT ARG_NAME)
    set(ARG_NAME urdfcheck)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  if(NOT ARG_PATHS)
    set(ARG_PATHS .)
  endif()
  set(command "${URDFCHECK_EXECUTABLE}")
  if(NOT command)
    message(WARNING "urdfcheck was not found: the test ${ARG_NAME} will fail until it is installed")
    set(command urdfcheck)
  endif()

  set(results "${CMAKE_CURRENT_BINARY_DIR}/test_results")
  if(AMENT_TEST_RESULTS_DIR)
    set(results "${AMENT_TEST_RESULTS_DIR}")
  endif()
  file(MAKE_DIRECTORY "${results}/${PROJECT_NAME}")

  add_test(
    NAME ${ARG_NAME}
    COMMAND "${command}" check ${ARG_OPTIONS} -o "junit=${results}/${PROJECT_NAME}/${ARG_NAME}.xunit.xml" -- ${ARG_PATHS}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
  )
  set_tests_properties(${ARG_NAME} PROPERTIES LABELS "linter;urdfcheck" TIMEOUT ${ARG_TIMEOUT})
endfunction()
