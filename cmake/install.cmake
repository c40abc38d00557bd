# `find_package(motorcade)` in another project gives motorcade::motorcade; pkg-config knows it as `motorcade`.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/motorcade)
install(TARGETS libmotorcade EXPORT motorcadeTargets)
install(EXPORT motorcadeTargets NAMESPACE motorcade:: DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/motorcadeConfig.cmake.in motorcadeConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(motorcadeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/motorcadeConfig.cmake ${PROJECT_BINARY_DIR}/motorcadeConfigVersion.cmake DESTINATION ${package_dir})
install(DIRECTORY include/motorcade DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(MOTORCADE_BUILD_APPS)
  install(TARGETS motorcade RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
