# The libraries that Lampyris depends on, all from Debian 12's packages; docs/decisions/ gives the reason for each.
add_library(lampyris_dependencies INTERFACE)
find_package(Threads REQUIRED)
find_package(ZLIB REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(OpenImageIO REQUIRED)
find_package(OpenColorIO REQUIRED HINTS /usr/share/cmake)  # Debian's file is not where CMake looks
find_package(glm REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
target_link_libraries(lampyris_dependencies INTERFACE
  Threads::Threads ZLIB::ZLIB TBB::tbb embree OpenEXR::OpenEXR OpenEXR::OpenEXRCore OpenColorIO::OpenColorIO glm::glm
  fmt::fmt spdlog::spdlog nlohmann_json::nlohmann_json ${CMAKE_DL_LIBS})
# Of lampyris_formats alone. By way of an interface, since Debian's OpenImageIO names an include folder of OpenCV's, which need not
# be there.
add_library(lampyris_openimageio INTERFACE)
target_link_libraries(lampyris_openimageio INTERFACE OpenImageIO::OpenImageIO)
if(LAMPYRIS_VULKAN)
  find_package(Vulkan REQUIRED)
  find_package(glslang REQUIRED CONFIG)
  find_package(SPIRV-Tools-opt REQUIRED CONFIG)
  target_link_libraries(lampyris_dependencies INTERFACE Vulkan::Vulkan)
  set(LAMPYRIS_VULKAN_LIBRARIES glslang::glslang glslang::SPIRV glslang::glslang-default-resource-limits SPIRV-Tools-opt)
endif()
