# lampyris_add_plugin(NAME SOURCES files... [KERNELS files...])
#
# A shared object NAME.so that `lampyris --plugin` and LAMPYRIS_PLUGIN_PATH load. Kernels are known by their path below the
# current folder's parent ("facing/facing.kernel.h"), as the built-in ones are known by theirs below src/.
set(LAMPYRIS_PLUGIN_DIR ${CMAKE_CURRENT_LIST_DIR})

function(lampyris_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;KERNELS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_SOURCES)
    message(FATAL_ERROR "lampyris_add_plugin(${name} SOURCES files... [KERNELS files...]): wrong arguments: ${ARGN}")
  endif()
  set(kernels "")
  foreach(kernel ${arg_KERNELS})
    get_filename_component(kernel ${kernel} ABSOLUTE)
    list(APPEND kernels ${kernel})
  endforeach()
  add_library(${name} MODULE ${arg_SOURCES} ${LAMPYRIS_PLUGIN_DIR}/plugin_abi.cpp)
  set_target_properties(${name} PROPERTIES PREFIX "" POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PRIVATE Lampyris::lampyris)
  if(kernels)
    cmake_path(GET CMAKE_CURRENT_SOURCE_DIR PARENT_PATH base)
    lampyris_add_kernels(${name} BASE ${base} KERNELS ${kernels})
  endif()
endfunction()
