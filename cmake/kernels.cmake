# Kernels for the processor at hand: their sources are compiled twice, for any x86-64 and for x86-64-v3 (AVX2), and the program takes the
# version that its processor can run when it starts. All else is compiled for any x86-64. Both versions give the same bits.
#
# `motorcade_kernels(frontend a.cpp b.cpp)` adds the sources to motorcade_frontend. tools/dispatch_kernels.sh turns the two sets of objects into
# one in which each function is a jump to one of its versions. Sanitizers want neither its relinking nor its jumps: with MOTORCADE_DISPATCH off
# there is the version for x86-64-v3 alone. Other processors have one version.
string(TOLOWER "${CMAKE_SYSTEM_PROCESSOR}" processor)
set(MOTORCADE_X86_64 OFF)
if(processor MATCHES "^(x86_64|amd64)$")
  set(MOTORCADE_X86_64 ON)
endif()
set(can_dispatch ${MOTORCADE_X86_64})
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU OR CMAKE_CXX_FLAGS MATCHES "-fsanitize" OR CMAKE_BUILD_TYPE STREQUAL Debug)
  set(can_dispatch OFF)
endif()
option(MOTORCADE_DISPATCH "Choose between kernels for any x86-64 and for x86-64-v3 at start; else build those for x86-64-v3 alone" ${can_dispatch})

set(kernel_flags_v3 -march=x86-64-v3)

function(motorcade_kernels folder)
  if(NOT MOTORCADE_DISPATCH)
    target_sources(motorcade_${folder} PRIVATE ${ARGN})
    motorcade_units(motorcade_${folder} ${ARGN})
    if(MOTORCADE_X86_64)
      set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS ${kernel_flags_v3})
      set_source_files_properties(${ARGN} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
    return()
  endif()
  foreach(version any v3)
    set(objects motorcade_${folder}_kernels_${version})
    add_library(${objects} OBJECT ${ARGN})
    motorcade_group_units(${objects} kernels ${ARGN})
    # No symbol may be shared between versions by name.
    target_compile_options(${objects} PRIVATE
      $<TARGET_PROPERTY:motorcade_${folder},COMPILE_OPTIONS> $<$<CONFIG:Release>:-O3> -fno-gnu-unique ${kernel_flags_${version}})
    target_include_directories(${objects} PRIVATE
      ${PROJECT_SOURCE_DIR} $<TARGET_PROPERTY:motorcade_${folder},INTERFACE_INCLUDE_DIRECTORIES>)
    target_link_libraries(${objects} PRIVATE Eigen3::Eigen)
    target_compile_features(${objects} PRIVATE cxx_std_20)
    target_compile_definitions(${objects} PRIVATE $<TARGET_PROPERTY:motorcade_${folder},COMPILE_DEFINITIONS>)
    # Those for any processor are compiled as core is; synth has flags of its own.
    if(version STREQUAL any AND NOT folder STREQUAL synth AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
      target_precompile_headers(${objects} REUSE_FROM motorcade_core)
    endif()
  endforeach()
  set(dispatched ${CMAKE_CURRENT_BINARY_DIR}/${folder}_kernels.o)
  add_custom_command(OUTPUT ${dispatched}
    COMMAND ${CMAKE_COMMAND} -E env LD=${CMAKE_LINKER} OBJCOPY=${CMAKE_OBJCOPY} NM=${CMAKE_NM} READELF=${CMAKE_READELF} CXX=${CMAKE_CXX_COMPILER}
      ${PROJECT_SOURCE_DIR}/tools/dispatch_kernels.sh ${dispatched}
      $<TARGET_OBJECTS:motorcade_${folder}_kernels_any> -- $<TARGET_OBJECTS:motorcade_${folder}_kernels_v3>
    DEPENDS $<TARGET_OBJECTS:motorcade_${folder}_kernels_any> $<TARGET_OBJECTS:motorcade_${folder}_kernels_v3>
      ${PROJECT_SOURCE_DIR}/tools/dispatch_kernels.sh
    COMMENT "Dispatching the kernels of ${folder}"
    VERBATIM COMMAND_EXPAND_LISTS)
  set_source_files_properties(${dispatched} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  target_sources(motorcade_${folder} PRIVATE ${dispatched})
endfunction()
