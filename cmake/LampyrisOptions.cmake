# Compiler options that every target shares, as an interface target.
add_library(lampyris_options INTERFACE)
target_compile_options(lampyris_options INTERFACE
  -Wall -Wextra -Wpedantic -Wno-unknown-pragmas
  # Same seed, same image on both backends: no contraction of a*b+c anywhere, host code included.
  -ffp-contract=off)
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
  target_compile_options(lampyris_options INTERFACE -fsanitize=${LAMPYRIS_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(lampyris_options INTERFACE -fsanitize=${LAMPYRIS_SANITIZE})
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
