# cmake --install, and find_package(Lampyris) for plugins outside this tree.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Lampyris)

# The Lampyris that a plugin is built for: the build regenerates this header when one of the headers that plugins see
# changes.
file(GLOB_RECURSE plugin_headers CONFIGURE_DEPENDS src/core/*.h)
list(APPEND plugin_headers ${material_headers})
set(abi_header ${PROJECT_BINARY_DIR}/generated/core/plugin_abi.h)
add_custom_command(OUTPUT ${abi_header}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${abi_header} "-DHEADERS=${plugin_headers}"
    -DVERSION=${PROJECT_VERSION} "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${LAMPYRIS_SANITIZE}"
    -P ${PROJECT_SOURCE_DIR}/cmake/LampyrisAbi.cmake
  DEPENDS ${plugin_headers} ${PROJECT_SOURCE_DIR}/cmake/LampyrisAbi.cmake
  COMMENT "Hashing the headers that plugins see" VERBATIM)
target_sources(lampyris PRIVATE ${abi_header})

set_target_properties(lampyris PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
install(TARGETS lampyris lampyris_abi EXPORT LampyrisTargets)
set_target_properties(lampyris_formats PROPERTIES INSTALL_RPATH $ORIGIN)
install(TARGETS lampyris_formats DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET lampyris_vectors)
  install(TARGETS lampyris_vectors DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
if(TARGET lampyris_program)
  file(RELATIVE_PATH to_library ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
  set_target_properties(lampyris_program PROPERTIES INSTALL_RPATH $ORIGIN/${to_library})
  install(TARGETS lampyris_program)
endif()
install(EXPORT LampyrisTargets NAMESPACE Lampyris:: DESTINATION ${package_dir})
install(DIRECTORY src/core DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lampyris FILES_MATCHING PATTERN *.h PATTERN *.glsl)
# Materials are compiled into every kernel, including those of plugins.
install(DIRECTORY src/materials ${PROJECT_BINARY_DIR}/generated/materials ${LAMPYRIS_EXTRA_MATERIALS}
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lampyris FILES_MATCHING PATTERN *.h)
# Photon maps and their consumers, which are combined with those of plugins.
install(DIRECTORY src/accel src/integrators DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lampyris
  FILES_MATCHING PATTERN *.h PATTERN *.cmake)
# Installed files keep the dates of their sources, which may be earlier than a plugin's last build. This file is dated
# when its contents last changed, and plugins are rebuilt completely after that.
install(CODE "
  set(abi_header \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/lampyris/core/plugin_abi.h\")
  file(COPY_FILE \"${abi_header}\" \"\${abi_header}\" ONLY_IF_DIFFERENT)
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES \"\${abi_header}\")")
set(LAMPYRIS_KERNELS ${CMAKE_INSTALL_INCLUDEDIR}/lampyris)
configure_package_config_file(cmake/LampyrisConfig.cmake.in ${PROJECT_BINARY_DIR}/LampyrisConfig.cmake
  INSTALL_DESTINATION ${package_dir} PATH_VARS LAMPYRIS_KERNELS)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/LampyrisConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/LampyrisConfig.cmake ${PROJECT_BINARY_DIR}/LampyrisConfigVersion.cmake
  cmake/LampyrisKernels.cmake cmake/LampyrisPlugin.cmake cmake/cpu_kernel.cpp.in
  cmake/plugin_abi.cpp
  DESTINATION ${package_dir})
install(FILES LICENSE README.md CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN plan.md EXCLUDE)

add_library(Lampyris::lampyris ALIAS lampyris)
include(LampyrisPlugin)
