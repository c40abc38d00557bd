# `find_package(motorcade)` in another project gives motorcade::motorcade and the libraries that it is made of.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/motorcade)
install(TARGETS motorcade_core motorcade_frontend motorcade_backend motorcade_io motorcade_pipeline motorcade_all EXPORT motorcadeTargets)
install(EXPORT motorcadeTargets NAMESPACE motorcade:: DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/motorcadeConfig.cmake.in motorcadeConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(motorcadeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/motorcadeConfig.cmake
  ${PROJECT_BINARY_DIR}/motorcadeConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/library_dependencies.cmake
  DESTINATION ${package_dir})
install(DIRECTORY core frontend backend io DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/motorcade FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY apps/pipeline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/motorcade/apps FILES_MATCHING PATTERN "*.hpp")
if(MOTORCADE_BUILD_APPS)
  install(TARGETS motorcade RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
