# Add a test that checks robot models with urdfcheck.
#
#   ament_urdfcheck()                                       # all models of the package
#   ament_urdfcheck(urdf/arm.urdf.xacro TESTNAME arm OPTIONS --fail-on warning --arg side:=left)
#
# :param TESTNAME: the name of the test, default: "urdfcheck"
# :param CONFIG_FILE: the configuration; default: the variable ament_cmake_urdfcheck_CONFIG_FILE, or else the nearest
#   urdfcheck.toml or pyproject.toml above each file
# :param EXCLUDE: files and folders to skip: patterns relative to the package, or absolute paths; those of the variable
#   ament_cmake_urdfcheck_EXCLUDE are skipped too
# :param OPTIONS: further options of urdfcheck check; those of the variable ament_cmake_urdfcheck_OPTIONS come before them
# :param TIMEOUT: seconds for the test, default: 600
# :param ARGN: the models, packages and folders to check, relative to the package; default: the package
#
# @public
function(ament_urdfcheck)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "TESTNAME;CONFIG_FILE;TIMEOUT" "EXCLUDE;OPTIONS")
  if(NOT ARG_TESTNAME)
    set(ARG_TESTNAME "urdfcheck")
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  if(NOT ARG_CONFIG_FILE AND ament_cmake_urdfcheck_CONFIG_FILE)
    set(ARG_CONFIG_FILE "${ament_cmake_urdfcheck_CONFIG_FILE}")
  endif()

  find_program(ament_urdfcheck_BIN NAMES "ament_urdfcheck")
  if(NOT ament_urdfcheck_BIN)
    message(FATAL_ERROR "ament_urdfcheck() could not find program 'ament_urdfcheck'")
  endif()

  set(result_file "${AMENT_TEST_RESULTS_DIR}/${PROJECT_NAME}/${ARG_TESTNAME}.xunit.xml")
  set(cmd "${ament_urdfcheck_BIN}" ${ament_cmake_urdfcheck_OPTIONS} ${ARG_OPTIONS} "--xunit-file" "${result_file}")
  if(ARG_CONFIG_FILE)
    list(APPEND cmd "--config" "${ARG_CONFIG_FILE}")
  endif()
  set(excluded ${ament_cmake_urdfcheck_EXCLUDE} ${ARG_EXCLUDE})
  if(excluded)
    list(APPEND cmd "--exclude" ${excluded})
  endif()
  # Behind --, so that no path is taken for a pattern or for the value of an option.
  list(APPEND cmd "--" ${ARG_UNPARSED_ARGUMENTS})
  if(NOT ARG_UNPARSED_ARGUMENTS)
    list(APPEND cmd ".")
  endif()

  ament_add_test(
    "${ARG_TESTNAME}"
    COMMAND ${cmd}
    OUTPUT_FILE "${CMAKE_BINARY_DIR}/ament_urdfcheck/${ARG_TESTNAME}.txt"
    RESULT_FILE "${result_file}"
    TIMEOUT "${ARG_TIMEOUT}"
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
  )
  set_tests_properties("${ARG_TESTNAME}" PROPERTIES LABELS "urdfcheck;linter")
endfunction()
