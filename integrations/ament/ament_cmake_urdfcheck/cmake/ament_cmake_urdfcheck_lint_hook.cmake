# Called by ament_lint_auto for a package that depends on ament_cmake_urdfcheck and has robot models.
file(GLOB_RECURSE _urdfcheck_models FOLLOW_SYMLINKS "*.urdf" "*.xacro")
if(_urdfcheck_models)
  message(STATUS "Added test 'urdfcheck' to check robot models")
  # A package may hold nothing but macros for others: there is nothing to check then.
  ament_urdfcheck(EXCLUDE ${AMENT_LINT_AUTO_FILE_EXCLUDE} OPTIONS --allow-empty)
endif()
