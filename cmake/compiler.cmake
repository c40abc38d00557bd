# Language level, warnings and target processor, the same for every target of the project.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Of the shared library, what its public headers mark is seen alone.
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # What ccache wants to know of precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endif()
# The compiler's own garbage collection costs an eighth of its time at the default of 128 MB.
add_compile_options($<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>)

# Programs at any address, with nothing to overwrite that tells where calls go, and with checks of the C library and of stack frames, where
# the compiler can see how large a buffer is. Sanitizers check more, and do not go with the first.
include(CheckPIESupported)
check_pie_supported()
add_link_options(LINKER:-z,relro,-z,now,-z,noexecstack)
add_compile_options(-fstack-protector-strong)
if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  add_compile_options($<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=3>)
endif()

# One library per folder: `motorcade_library(core a.cpp b.cpp)` makes motorcade_core and motorcade::core. COLD after the name marks a folder
# that runs once per command, such as options, tables and pages: the compiler need not work on it for long.
function(motorcade_library folder)
  cmake_parse_arguments(PARSE_ARGV 1 library "COLD" "" "")
  set(sources ${library_UNPARSED_ARGUMENTS})
  add_library(motorcade_${folder} STATIC ${sources})
  add_library(motorcade::${folder} ALIAS motorcade_${folder})
  set_target_properties(motorcade_${folder} PROPERTIES EXPORT_NAME ${folder})
  target_include_directories(motorcade_${folder} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/motorcade>)
  motorcade_options(motorcade_${folder})
  if(library_COLD)
    motorcade_cold(motorcade_${folder})
    math(EXPR MOTORCADE_UNIT_SOURCES "3 * ${MOTORCADE_UNIT_SOURCES} / 2")
  endif()
  motorcade_units(motorcade_${folder} ${sources})
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)  # else folders would wait for each other all the same
    motorcade_precompiled_headers(${folder} ${library_COLD})
  endif()
endfunction()

# Compiles targets with -O1: what runs once per command gains nothing from more.
function(motorcade_cold)
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endforeach()
endfunction()

# Sources of a cold folder that work on every frame, compiled as elsewhere.
function(motorcade_hot)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O3> SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# With CMAKE_UNITY_BUILD (the presets but `developer`) sources of one room are compiled together, a few to a unit: about half of the compiler's
# time, and a changed source is back in the program within seconds. In its anonymous namespaces a room uses each name once.
# `motorcade_units(target a.cpp b.cpp)` groups the sources; those with flags or definitions of their own stay alone.
set(MOTORCADE_UNIT_SOURCES 15 CACHE STRING "Sources that are compiled together with CMAKE_UNITY_BUILD, at most; half as many again in cold folders")
function(motorcade_units target)
  set(rooms)
  foreach(source ${ARGN})
    cmake_path(GET source PARENT_PATH room)
    string(MAKE_C_IDENTIFIER "room_${room}" room)
    list(APPEND rooms ${room})
    list(APPEND ${room} ${source})
  endforeach()
  list(REMOVE_DUPLICATES rooms)
  foreach(room ${rooms})
    motorcade_group_units(${target} ${room} ${${room}})
  endforeach()
endfunction()

# The sources of one group in units of about the same length.
function(motorcade_group_units target group)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  list(LENGTH ARGN count)
  math(EXPR units "(${count} + ${MOTORCADE_UNIT_SOURCES} - 1) / ${MOTORCADE_UNIT_SOURCES}")
  set(position 0)
  foreach(source ${ARGN})
    math(EXPR unit "${position} * ${units} / ${count}")
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${group}_${unit})
    math(EXPR position "${position} + 1")
  endforeach()
endfunction()

# What nearly every file includes is parsed once per set of flags: by core for itself and the estimators, and by io for the cold folders. GCC
# keeps the optimization level of the parsed headers wherever fmt restores it, so folders of two levels share none. No file may rely on them:
# each includes what it uses, and .ci/lint compiles without.
function(motorcade_precompiled_headers folder cold)
  set(headers <algorithm> <array> <atomic> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional> <span> <sstream>
    <string> <thread> <utility> <vector> <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry>)
  if(folder STREQUAL core)
    target_precompile_headers(motorcade_core PRIVATE ${headers})
  elseif(folder STREQUAL io)
    target_precompile_headers(motorcade_io PRIVATE ${headers} <nlohmann/json.hpp>)
  elseif(NOT cold)
    target_precompile_headers(motorcade_${folder} REUSE_FROM motorcade_core)
  elseif(NOT folder STREQUAL synth)  # it has flags of its own
    target_precompile_headers(motorcade_${folder} REUSE_FROM motorcade_io)
  endif()
endfunction()

function(motorcade_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast -Werror
    -Wno-array-bounds)  # GCC 12 mistakes Eigen's vector loads from 3-vectors for overruns
  # Errno is not read after a square root, and no floating-point exception is trapped: such loops become vector code, with the same values.
  target_compile_options(${target} PRIVATE -fno-math-errno -fno-trapping-math)
  # Choices (a hypothesis, a point at a gate) hang on last bits: round in the same way on every processor, without fusing multiplications with
  # additions and without Eigen's vectors, whose sums depend on their width. Alignment stays what it is elsewhere.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  target_compile_definitions(${target} PRIVATE EIGEN_DONT_VECTORIZE EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MAX_STATIC_ALIGN_BYTES=16)
  # Vectors of 32 bytes pass between functions of one file only, so that no caller depends on how. Without Eigen's vectors GCC 12 takes the
  # entries that a short vector does not use for read.
  target_compile_options(${target} PRIVATE -Wno-psabi $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endfunction()

find_path(HWY_INCLUDE_DIR hwy/foreach_target.h REQUIRED)  # Highway; its library is not needed
# Kernels: Highway compiles them for several instruction sets, and the program takes the best that its processor has when it first calls one
# (core/instruction_set.hpp). A source includes itself once for each, so it is a unit of its own.
# Others than x86-64 have one version; NEON is a part of arm64.
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|amd64|AMD64)$")
  add_compile_definitions(HWY_COMPILE_ONLY_SCALAR)
endif()
function(motorcade_kernels target)
  target_sources(${target} PRIVATE ${ARGN})
  set_property(SOURCE ${ARGN} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
