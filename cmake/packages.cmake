# Debian's packages, split as Debian does: `cpack -G DEB` in a build folder that was configured with CMAKE_INSTALL_PREFIX=/usr
# (tests/packages.sh makes and tries them).
set(library_package libmotorcade${MOTORCADE_SOVERSION})
set(components runtime dev modules program python)
set(package_runtime ${library_package})
set(package_dev libmotorcade-dev)
set(package_modules ${library_package}-modules)
set(package_program motorcade)
set(package_python python3-motorcade)

# Each package has Debian's copyright and changelog.
find_program(GZIP gzip REQUIRED)
set(changelog ${PROJECT_BINARY_DIR}/packaging/changelog.gz)
add_custom_command(OUTPUT ${changelog}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/packaging
  COMMAND ${GZIP} -9nc ${PROJECT_SOURCE_DIR}/packaging/changelog > ${changelog}
  DEPENDS packaging/changelog VERBATIM)
add_custom_target(motorcade_changelog ALL DEPENDS ${changelog})
foreach(component ${components})
  set(docs ${CMAKE_INSTALL_DATADIR}/doc/${package_${component}})
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/copyright ${changelog} DESTINATION ${docs} COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME motorcade)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(MOTORCADE_MAINTAINER "Motorcade developers <developers@motorcade.invalid>" CACHE STRING "Who answers for the packages")
set(CPACK_PACKAGE_CONTACT ${MOTORCADE_MAINTAINER})
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/apps/interface)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

function(debian_package component section summary text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_${component}} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
endfunction()
set(about "Motorcade follows a car's own path and the paths of the moving vehicles\naround it from one stereo camera, in real time, on two processor cores.")
debian_package(runtime libs "multibody visual SLAM from a stereo camera - library" "${about}\n.\nThis package holds the shared library.")
debian_package(dev libdevel "multibody visual SLAM from a stereo camera - headers"
  "${about}\n.\nThis package holds what programs in C and C++ are built with.")
debian_package(modules libs "multibody visual SLAM from a stereo camera - modules"
  "${about}\n.\nThis package holds what the library loads on request: SIFT points, and the\nreader of calibrations in YAML.")
debian_package(program science "multibody visual SLAM from a stereo camera - program"
  "${about}\n.\nThis package holds the program that follows recorded drives, measures, draws\nand reports.")
debian_package(python python "multibody visual SLAM from a stereo camera - Python" "${about}\n.\nThis package holds the interface for Python.")

set(same_version "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/triggers)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "${package_modules} ${same_version}")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${library_package} ${same_version}")
set(CPACK_DEBIAN_MODULES_PACKAGE_DEPENDS "${library_package} ${same_version}")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${library_package} ${same_version}, python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "${package_modules}")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib")

set(CPACK_COMPONENTS_ALL runtime dev modules)
if(MOTORCADE_BUILD_APPS)
  list(APPEND CPACK_COMPONENTS_ALL program)
endif()
if(MOTORCADE_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
include(CPack)
