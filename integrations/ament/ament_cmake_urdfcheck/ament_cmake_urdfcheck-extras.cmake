# Read by find_package(ament_cmake_urdfcheck): the function, and the hook of ament_lint_auto.
find_package(ament_cmake_test QUIET REQUIRED)

include("${ament_cmake_urdfcheck_DIR}/ament_urdfcheck.cmake")

ament_register_extension("ament_lint_auto" "ament_cmake_urdfcheck" "ament_cmake_urdfcheck_lint_hook.cmake")
