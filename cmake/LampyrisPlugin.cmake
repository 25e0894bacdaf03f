# lampyris_add_plugin(NAME SOURCES files... [KERNELS files...] [HEADERS files...] [GATHERS files...] [CONSUMERS files...])
#
# A shared object NAME.so that `lampyris --plugin` and LAMPYRIS_PLUGIN_PATH load. Kernels are identified by their path
# below the current folder's parent ("facing/facing.radiance.h"), like the built-in ones by theirs below src/.
# HEADERS are the files that kernels include, other than Lampyris' own. A photon map's GATHERS are built with each
# consumer of Lampyris and of this plugin, and CONSUMERS with each photon map.
set(LAMPYRIS_PLUGIN_DIR ${CMAKE_CURRENT_LIST_DIR})

# How Lampyris' photon maps and consumers are built.
file(GLOB_RECURSE lampyris_declarations ${LAMPYRIS_KERNEL_INCLUDE}/accel/*.cmake ${LAMPYRIS_KERNEL_INCLUDE}/integrators/*.cmake)
foreach(lampyris_declaration IN LISTS lampyris_declarations)
  include(${lampyris_declaration})
endforeach()

function(lampyris_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;KERNELS;HEADERS;GATHERS;CONSUMERS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_SOURCES)
    message(FATAL_ERROR "lampyris_add_plugin(${name} SOURCES files... [KERNELS files...] [HEADERS files...] [GATHERS files...] [CONSUMERS files...]): wrong arguments: ${ARGN}")
  endif()
  add_library(${name} MODULE ${arg_SOURCES} ${LAMPYRIS_PLUGIN_DIR}/plugin_abi.cpp)
  set_target_properties(${name} PROPERTIES PREFIX "" POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PRIVATE Lampyris::lampyris)
  if(NOT CMAKE_CXX_FLAGS MATCHES "-O")  # as for Lampyris itself: without a build type, kernels would be several times slower
    target_compile_options(${name} PRIVATE $<$<CONFIG:>:-O3>)
    target_compile_definitions(${name} PRIVATE $<$<CONFIG:>:NDEBUG>)
  endif()
  foreach(kind KERNELS HEADERS GATHERS CONSUMERS)
    list(TRANSFORM arg_${kind} PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  endforeach()
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR PARENT_PATH base)
  file(GLOB_RECURSE gathers RELATIVE ${LAMPYRIS_KERNEL_INCLUDE} ${LAMPYRIS_KERNEL_INCLUDE}/*.gather.h)
  file(GLOB_RECURSE consumers RELATIVE ${LAMPYRIS_KERNEL_INCLUDE} ${LAMPYRIS_KERNEL_INCLUDE}/*.consumer.h)
  lampyris_add_kernels(${name} BASE ${base} KERNELS ${arg_KERNELS} HEADERS ${arg_HEADERS} GATHERS ${arg_GATHERS}
    CONSUMERS ${arg_CONSUMERS} OTHER_GATHERS ${gathers} OTHER_CONSUMERS ${consumers})
  if(LAMPYRIS_ABI_HEADER)  # another Lampyris was installed: its photon maps may differ, so everything is rebuilt
    lampyris_configured_by(${LAMPYRIS_ABI_HEADER})
    get_target_property(sources ${name} SOURCES)
    set_property(SOURCE ${sources} APPEND PROPERTY OBJECT_DEPENDS ${LAMPYRIS_ABI_HEADER})
  endif()
endfunction()
