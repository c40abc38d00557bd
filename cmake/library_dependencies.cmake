# What the libraries need, here and in a project that uses the installed package. Everything comes from Debian's packages; apps/setup.sh
# installs them.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB 2021 REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(Threads REQUIRED)
find_package(nlohmann_json 3 REQUIRED)
find_path(CCOLAMD_INCLUDE_DIR ccolamd.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CCOLAMD_LIBRARY ccolamd REQUIRED)
add_library(motorcade::ccolamd UNKNOWN IMPORTED)
set_target_properties(motorcade::ccolamd PROPERTIES
  IMPORTED_LOCATION ${CCOLAMD_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${CCOLAMD_INCLUDE_DIR})
find_path(YAML_CPP_INCLUDE_DIR yaml-cpp/yaml.h REQUIRED)
find_library(YAML_CPP_LIBRARY yaml-cpp REQUIRED)
add_library(motorcade::yaml UNKNOWN IMPORTED)
set_target_properties(motorcade::yaml PROPERTIES
  IMPORTED_LOCATION ${YAML_CPP_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${YAML_CPP_INCLUDE_DIR})
find_path(DEFLATE_INCLUDE_DIR libdeflate.h REQUIRED)
find_library(DEFLATE_LIBRARY NAMES libdeflate.a deflate REQUIRED)  # 60 kB in the library rather than one more to load
add_library(motorcade::deflate UNKNOWN IMPORTED)
set_target_properties(motorcade::deflate PROPERTIES
  IMPORTED_LOCATION ${DEFLATE_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${DEFLATE_INCLUDE_DIR})
