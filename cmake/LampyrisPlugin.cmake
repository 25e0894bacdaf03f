# lampyris_add_plugin(NAME SOURCES files... [KERNELS files...] [HEADERS files...])
#
# A shared object NAME.so that `lampyris --plugin` and LAMPYRIS_PLUGIN_PATH load. Kernels are known by their path below the
# current folder's parent ("facing/facing.kernel.h"), as the built-in ones are known by theirs below src/.
# HEADERS are what kernels include, beyond Lampyris' own.
set(LAMPYRIS_PLUGIN_DIR ${CMAKE_CURRENT_LIST_DIR})

function(lampyris_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;KERNELS;HEADERS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_SOURCES)
    message(FATAL_ERROR "lampyris_add_plugin(${name} SOURCES files... [KERNELS files...] [HEADERS files...]): wrong arguments: ${ARGN}")
  endif()
  add_library(${name} MODULE ${arg_SOURCES} ${LAMPYRIS_PLUGIN_DIR}/plugin_abi.cpp)
  set_target_properties(${name} PROPERTIES PREFIX "" POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PRIVATE Lampyris::lampyris)
  list(TRANSFORM arg_KERNELS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  list(TRANSFORM arg_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR PARENT_PATH base)
  lampyris_add_kernels(${name} BASE ${base} KERNELS ${arg_KERNELS} HEADERS ${arg_HEADERS})
endfunction()
