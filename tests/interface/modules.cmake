# The shared library, what comes with it, and its modules.
set(modules $<TARGET_FILE:motorcade_sift_module> $<TARGET_FILE:motorcade_yaml_module>)
if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")  # which bring libraries of their own
  add_test(NAME interface.Dependencies
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/dependencies_test.sh $<TARGET_FILE:libmotorcade> ${modules})
endif()
if(MOTORCADE_BUILD_APPS)  # which render the drive
  add_executable(module_user module_user.cpp)
  motorcade_options(module_user)
  target_link_libraries(module_user PRIVATE motorcade::motorcade)
  target_link_options(module_user PRIVATE LINKER:--enable-new-dtags)  # LD_LIBRARY_PATH comes before the build's folder
  add_test(NAME interface.Modules COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/modules_test.sh
    $<TARGET_FILE:module_user> $<TARGET_FILE:motorcade> $<TARGET_FILE:libmotorcade> ${PROJECT_BINARY_DIR}/tests/apps/rendered_tiny)
  set_tests_properties(interface.Modules PROPERTIES FIXTURES_REQUIRED rendered_tiny)
endif()
