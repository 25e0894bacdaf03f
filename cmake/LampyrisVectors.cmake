# Kernels in vectors for the CPU backend: LLVM, and what translates kernels for it, are a library of their own, which is loaded when
# a kernel has run for a while (backends/cpu/vectors.h). Kernels are translated from their SPIR-V, so that Vulkan's compiler is
# needed, and for AVX2.
if(NOT LAMPYRIS_VECTORS OR NOT LAMPYRIS_VULKAN OR NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  return()
endif()
find_package(LLVM 15 CONFIG)
if(NOT LLVM_FOUND)
  message(FATAL_ERROR "LLVM 15 (Debian: llvm-15-dev) was not found. Without it: -DLAMPYRIS_VECTORS=OFF (kernels on the CPU take up to 1.4 times as long)")
endif()
file(GLOB vector_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/backends/vectors/*.cpp)
file(GLOB vector_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/backends/vectors/*.h)
# Machine code on disk belongs to the translator that made it.
set(version_header ${PROJECT_BINARY_DIR}/generated/vectors/backends/vectors/version.h)
add_custom_command(OUTPUT ${version_header}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${version_header} "-DFILES=${vector_sources};${vector_headers}" -DNAME=LAMPYRIS_VECTORS_VERSION
    -P ${PROJECT_SOURCE_DIR}/cmake/LampyrisHash.cmake
  DEPENDS ${vector_sources} ${vector_headers} ${PROJECT_SOURCE_DIR}/cmake/LampyrisHash.cmake
  COMMENT "Hashing the translator to vectors" VERBATIM)
add_library(lampyris_vectors MODULE ${vector_sources} ${version_header})
set_target_properties(lampyris_vectors PROPERTIES PREFIX lib INSTALL_RPATH $ORIGIN)
target_include_directories(lampyris_vectors PRIVATE ${PROJECT_BINARY_DIR}/generated/vectors)
target_include_directories(lampyris_vectors SYSTEM PRIVATE ${LLVM_INCLUDE_DIRS})
target_link_libraries(lampyris_vectors PRIVATE lampyris LLVM)
