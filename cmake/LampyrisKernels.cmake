# lampyris_add_kernels(TARGET BASE dirs... KERNELS files... HEADERS files... GATHERS files... CONSUMERS files...
#                      OTHER_GATHERS names... OTHER_CONSUMERS names...)
#
# Makes kernel files part of a target, for both compilers: each *.kernel.h and *.radiance.h becomes C++ translation units
# (see lampyris_kernel). Its text and the headers' texts are embedded (.incbin) for glslang at run time. A file is identified
# by its path below a folder of BASE ("integrators/path/path.radiance.h"); the kernel's name is the file's name.
#
# A gather kernel is a pair of files, CONSUMER+GATHER (src/core/kernel/gather.h): each gather file is built with each
# consumer, including those of another target (OTHER_..., by name), and vice versa.
set(LAMPYRIS_KERNELS_DIR ${CMAKE_CURRENT_LIST_DIR})

# lampyris_kernel(FILE [GLSL_ONLY] [CPU_EFFECTS sets...])
#
# How the C++ compiler builds a kernel of the current folder. Stands in the folder's NAME.cmake, or in a plugin's
# CMakeLists.txt before lampyris_add_plugin. There is always one build that has all effects and can log paths, for replays
# (core/kernel/path_log.h).
#
#   GLSL_ONLY    there is none: the kernel needs hardware that no CPU backend has
#   CPU_EFFECTS  there is one build more for each of these sets of effects (core/kernel/effects.h), in quotes if they are
#                expressions; a scene runs on the smallest one that has all of its effects. kAllEffects: all, but no log
function(lampyris_kernel file)
  cmake_parse_arguments(PARSE_ARGV 1 arg "GLSL_ONLY" "" "CPU_EFFECTS")
  set(where "${CMAKE_CURRENT_LIST_FILE}: lampyris_kernel(${file} ...)")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "${where}: wrong arguments: ${ARGN}; cmake/LampyrisKernels.cmake says what it takes")
  endif()
  set(path ${CMAKE_CURRENT_LIST_DIR}/${file})
  if(NOT EXISTS ${path})
    message(FATAL_ERROR "${where}: there is no such file")
  endif()
  foreach(word GLSL_ONLY CPU_EFFECTS)
    set_property(GLOBAL PROPERTY "LAMPYRIS_KERNEL_${word}:${path}" "${arg_${word}}")
  endforeach()
endfunction()

function(lampyris_add_kernels target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "BASE;KERNELS;HEADERS;GATHERS;CONSUMERS;OTHER_GATHERS;OTHER_CONSUMERS")
  set(out ${CMAKE_CURRENT_BINARY_DIR}/kernels/${target})
  string(MAKE_C_IDENTIFIER "lampyris_text_${target}" symbols)
  set(content "#include \"core/device/kernel_registry.h\"\n")
  set(index 0)
  set(files ${arg_KERNELS} ${arg_HEADERS} ${arg_GATHERS} ${arg_CONSUMERS})
  foreach(file ${files})
    lampyris_kernel_name(${file} "${arg_BASE}" name)
    if(name MATCHES "\\+")
      message(FATAL_ERROR "${file}: a kernel's folder and name cannot have a '+', which joins the files of a kernel of several; name it otherwise")
    endif()
    set(symbol "${symbols}_${index}")
    string(REGEX REPLACE "([\\\"])" "\\\\\\1" path "${file}")
    # Hidden, so that a plugin's texts are not confused with those of another plugin that has a target of the same name.
    string(APPEND content "asm(R\"asm(.pushsection .rodata\n.hidden ${symbol}, ${symbol}_end\n.global ${symbol}, ${symbol}_end\n"
      "${symbol}: .incbin \"${path}\"\n${symbol}_end: .byte 0\n.popsection)asm\");\n"
      "extern \"C\" const char ${symbol}[], ${symbol}_end[];\n"
      "static const lampyris::KernelText text_${index}{\"${name}\", {${symbol}, size_t(${symbol}_end - ${symbol})}};\n")
    math(EXPR index "${index} + 1")
  endforeach()
  # Uses the C++ compiler's own assembler, so that a plugin's project need not enable another language in any of its
  # folders.
  file(CONFIGURE OUTPUT ${out}/texts.cpp CONTENT "@content@" @ONLY)
  set_source_files_properties(${out}/texts.cpp PROPERTIES OBJECT_DEPENDS "${files}")
  target_sources(${target} PRIVATE ${out}/texts.cpp)
  # Each unit includes the kernel headers again, inside its own struct. Other sources may form units.
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)

  foreach(file ${arg_KERNELS})
    lampyris_kernel_name(${file} "${arg_BASE}" name)
    lampyris_kernel_units(${target} ${out} "${name}" ${file})
  endforeach()

  set(gathers "")
  foreach(file ${arg_GATHERS})
    lampyris_kernel_name(${file} "${arg_BASE}" name)
    lampyris_glsl_only(${file} glsl_only)
    if(NOT glsl_only)
      list(APPEND gathers ${name})
    endif()
  endforeach()
  set(other_gathers "")
  foreach(name ${arg_OTHER_GATHERS})
    lampyris_glsl_only(${LAMPYRIS_KERNEL_INCLUDE}/${name} glsl_only)
    if(NOT glsl_only)
      list(APPEND other_gathers ${name})
    endif()
  endforeach()
  foreach(file ${arg_CONSUMERS})
    lampyris_kernel_name(${file} "${arg_BASE}" name)
    foreach(gather ${gathers} ${other_gathers})
      lampyris_kernel_units(${target} ${out} "${name}+${gather}" ${file})
    endforeach()
  endforeach()
  foreach(consumer ${arg_OTHER_CONSUMERS})
    foreach(gather ${gathers})
      lampyris_kernel_units(${target} ${out} "${consumer}+${gather}" ${LAMPYRIS_KERNEL_INCLUDE}/${consumer})
    endforeach()
  endforeach()
  target_include_directories(${target} PRIVATE ${arg_BASE})
endfunction()

# The name under which kernels include a file: its path below the first of `bases` that contains it.
function(lampyris_kernel_name file bases result)
  foreach(base IN LISTS bases)
    cmake_path(IS_PREFIX base ${file} NORMALIZE below)
    if(below)
      file(RELATIVE_PATH name ${base} ${file})
      set(${result} ${name} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  message(FATAL_ERROR "${file}: in none of ${bases}")
endfunction()

# Configuration reads these files: when one changes, configure again.
function(lampyris_configured_by file)
  get_property(known DIRECTORY PROPERTY CMAKE_CONFIGURE_DEPENDS)
  if(NOT file IN_LIST known)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  endif()
endfunction()

# Whether a file is not compiled as C++.
function(lampyris_glsl_only file result)
  get_property(glsl_only GLOBAL PROPERTY "LAMPYRIS_KERNEL_GLSL_ONLY:${file}")
  if(glsl_only)
    set(${result} ON PARENT_SCOPE)
  else()
    set(${result} OFF PARENT_SCOPE)
  endif()
endfunction()

# The C++ units of one kernel, whose name is its files' names joined by '+'; `file` is the one whose effect sets count. There is one unit for each set, so that they compile in parallel.
function(lampyris_kernel_units target out KERNEL_FILE file)
  string(REPLACE "+" ";" parts "${KERNEL_FILE}")
  set(KERNEL_NAME "")
  set(KERNEL_INCLUDES "")
  foreach(part ${parts})
    get_filename_component(name ${part} NAME)
    string(REGEX REPLACE "\\.(kernel\\.)?h$" "" name ${name})
    list(APPEND KERNEL_NAME ${name})
    string(APPEND KERNEL_INCLUDES "#include \"${part}\"\n")
  endforeach()
  if(KERNEL_FILE MATCHES "\\.radiance\\.h$")  # as kernel_parts does (core/device/kernel_registry.h)
    string(APPEND KERNEL_INCLUDES "#include \"core/kernel/pixel_loop.h\"\n")
  endif()
  list(JOIN KERNEL_NAME "+" KERNEL_NAME)
  set(variants "kAllEffects | EFFECT_PATH_LOG")
  if(NOT DEFINED LAMPYRIS_SPECIALISED_KERNELS OR LAMPYRIS_SPECIALISED_KERNELS)
    get_property(declared GLOBAL PROPERTY "LAMPYRIS_KERNEL_CPU_EFFECTS:${file}")
    list(APPEND variants ${declared})
  endif()
  set(number 0)
  foreach(KERNEL_VARIANT ${variants})
    # By default, GCC passes surfaces and materials through memory, which costs 10 % of a diffuse path's time. With
    # every effect, inlining everything would take a minute to compile.
    if(KERNEL_VARIANT MATCHES "^kAllEffects")
      set(KERNEL_INLINE_ALL OFF)
    else()
      set(KERNEL_INLINE_ALL ON)
    endif()
    set(unit ${out}/${KERNEL_NAME}.${number}.cpp)
    configure_file(${LAMPYRIS_KERNELS_DIR}/cpu_kernel.cpp.in ${unit} @ONLY)
    target_sources(${target} PRIVATE ${unit})
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()
