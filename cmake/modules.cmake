# What brings large libraries along, and is loaded when it is first asked for (core/module.hpp):
#   motorcade_module(yaml io SOURCES a.cpp LIBRARIES motorcade::yaml)
# makes the objects motorcade_yaml, which each program holds that links motorcade::io, and the module motorcade/yaml.so beside the shared
# library, which holds none of it. A module exports its one function.
function(motorcade_module name folder)
  cmake_parse_arguments(PARSE_ARGV 2 module "" "" "SOURCES;LIBRARIES")
  add_library(motorcade_${name} OBJECT ${module_SOURCES})
  motorcade_options(motorcade_${name})
  target_include_directories(motorcade_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(motorcade_${name} PRIVATE ${module_LIBRARIES})

  set(in_program $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  target_sources(motorcade_${folder} INTERFACE $<${in_program}:$<TARGET_OBJECTS:motorcade_${name}>>)
  foreach(library ${module_LIBRARIES})
    target_link_libraries(motorcade_${folder} INTERFACE $<${in_program}:${library}>)
  endforeach()

  set(library_folder ${PROJECT_BINARY_DIR}/apps/interface)
  if(CMAKE_LIBRARY_OUTPUT_DIRECTORY)  # a project that has Motorcade inside may say where libraries go
    set(library_folder ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
  endif()
  set(symbols ${PROJECT_SOURCE_DIR}/cmake/module_symbols.map)
  add_library(motorcade_${name}_module MODULE $<TARGET_OBJECTS:motorcade_${name}>)
  set_target_properties(motorcade_${name}_module PROPERTIES
    NO_SONAME ON PREFIX "" OUTPUT_NAME ${name} LINKER_LANGUAGE CXX LINK_DEPENDS ${symbols}
    LIBRARY_OUTPUT_DIRECTORY ${library_folder}/motorcade)
  target_link_options(motorcade_${name}_module PRIVATE LINKER:--version-script=${symbols} LINKER:--as-needed LINKER:-z,defs)
  target_link_libraries(motorcade_${name}_module PRIVATE ${module_LIBRARIES})
  install(TARGETS motorcade_${name}_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/motorcade COMPONENT modules)
  set_property(GLOBAL APPEND PROPERTY MOTORCADE_MODULES motorcade_${name}_module)
endfunction()
