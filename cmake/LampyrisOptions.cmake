# Compiler options that every target shares, as an interface target; those that a plugin outside this tree must share,
# too, as another.
add_library(lampyris_abi INTERFACE)
add_library(lampyris_options INTERFACE)
target_link_libraries(lampyris_options INTERFACE lampyris_abi)
# The same seed gives the same image on both backends: no contraction of a*b+c anywhere, host code included.
target_compile_options(lampyris_abi INTERFACE -ffp-contract=off
  # No code reads errno after sqrt or traps floating-point exceptions: neither option changes a value.
  -fno-math-errno -fno-trapping-math)
target_compile_definitions(lampyris_abi INTERFACE GLM_FORCE_XYZW_ONLY GLM_FORCE_SILENT_WARNINGS)
target_compile_features(lampyris_abi INTERFACE cxx_std_20)
target_compile_options(lampyris_options INTERFACE -Wall -Wextra -Wpedantic -Wno-unknown-pragmas)
option(LAMPYRIS_WERROR "Treat warnings as errors" ON)
if(LAMPYRIS_WERROR)
  target_compile_options(lampyris_options INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # -Wrestrict: GCC bug 105651, "literal" + std::string.
  # GLM 0.9.9 and GCC 12's flow analysis disagree about these; neither finds anything in our code.
  target_compile_options(lampyris_options INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-restrict)
endif()
if(LAMPYRIS_SANITIZE)
  target_compile_options(lampyris_abi INTERFACE -fsanitize=${LAMPYRIS_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(lampyris_abi INTERFACE -fsanitize=${LAMPYRIS_SANITIZE})
endif()
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
find_program(LLD_PROGRAM ld.lld)
if(LLD_PROGRAM)
  add_link_options(-fuse-ld=lld)
endif()
