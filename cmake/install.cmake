# `find_package(motorcade)` in another project gives motorcade::motorcade; pkg-config knows it as `motorcade`. Both may be moved to another
# prefix. Components are those of Debian's packages (cmake/packages.cmake).
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/motorcade)
install(TARGETS libmotorcade EXPORT motorcadeTargets
  LIBRARY COMPONENT runtime NAMELINK_COMPONENT dev
  ARCHIVE COMPONENT dev)
install(EXPORT motorcadeTargets NAMESPACE motorcade:: DESTINATION ${package_dir} COMPONENT dev)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/motorcadeConfig.cmake.in motorcadeConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(motorcadeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/motorcadeConfig.cmake ${PROJECT_BINARY_DIR}/motorcadeConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT dev)
if(NOT BUILD_SHARED_LIBS)  # what the archive is linked with
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/library_dependencies.cmake DESTINATION ${package_dir} COMPONENT dev)
endif()
install(DIRECTORY include/motorcade DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)

set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH prefix_of_pkgconfig /prefix/${pkgconfig_dir} /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/motorcade.pc.in motorcade.pc @ONLY)
if(BUILD_SHARED_LIBS)
  install(FILES ${PROJECT_BINARY_DIR}/motorcade.pc DESTINATION ${pkgconfig_dir} COMPONENT dev)
endif()

if(MOTORCADE_BUILD_APPS)
  install(TARGETS motorcade RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
