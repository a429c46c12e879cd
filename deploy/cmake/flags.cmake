# One interface target for warnings, code generation and sanitizers.
add_library(tessera_flags INTERFACE)
target_compile_options(tessera_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  -Wno-missing-field-initializers  # designated initialisers only name non-default members
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)  # false positives of GCC 12 in inlined std::string (GCC bug 105651)

# Results must be bit-identical for any compiling host: x86-64-v3, no FMA contraction, no fast-math.
target_compile_options(tessera_flags INTERFACE -march=x86-64-v3 -ffp-contract=off)

if(TESSERA_SANITIZE)
  target_compile_options(tessera_flags INTERFACE -fsanitize=${TESSERA_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(tessera_flags INTERFACE -fsanitize=${TESSERA_SANITIZE})
endif()
if(TESSERA_FUZZ)
  target_compile_options(tessera_flags INTERFACE -fno-sanitize-recover=all)  # undefined behaviour is a finding
endif()

find_program(TESSERA_MOLD mold)
if(TESSERA_MOLD)
  target_link_options(tessera_flags INTERFACE -fuse-ld=mold)
endif()
find_program(TESSERA_CCACHE ccache)
if(TESSERA_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${TESSERA_CCACHE})
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  # Assertions stay on: their cost is negligible. Line numbers for profilers take a tenth of the build time, so only
  # development builds have them.
  set(CMAKE_CXX_FLAGS_RELEASE "-O3")
  if(NOT CMAKE_UNITY_BUILD)
    set(CMAKE_CXX_FLAGS_RELEASE "-O3 -g1")
  endif()
endif()

# tessera_library(NAME SOURCES ... PUBLIC targets... PRIVATE targets...)
function(tessera_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} tessera_flags)
endfunction()
