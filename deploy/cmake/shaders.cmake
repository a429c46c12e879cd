# tessera_shaders(TARGET FILE.comp ... [DEFINES NAME=VALUE ...] [SUFFIX text] [KEEP_CALLS])
# Compiles GLSL for core Vulkan 1.3, checks it with spirv-val and embeds it in the target. Files are named from the
# repository root, as are their includes (#include "mediator/shading/..."), which are tracked. The SPIR-V words of
# backends/vulkan/shaders/trace.comp are then
#     #include "backends/vulkan/shaders/trace.comp.h"
#     std::span<const std::uint32_t> tessera::vulkan::shaders::trace_comp()
# SUFFIX distinguishes variants of one file: trace.comp with SUFFIX wide gives trace_wide.comp.h and trace_wide_comp().
# KEEP_CALLS disables inlining, for large kernels: glslc's optimiser inlines every call (path tracing: 20 times slower to
# compile, 3 times the words), and drivers inline themselves.
function(tessera_shaders target)
  cmake_parse_arguments(ARG "KEEP_CALLS" "SUFFIX" "DEFINES" ${ARGN})
  set(generated ${CMAKE_BINARY_DIR}/generated)
  list(TRANSFORM ARG_DEFINES PREPEND -D)
  set(optimise -O)
  if(ARG_KEEP_CALLS)
    set(optimise -O0)
  endif()
  foreach(file IN LISTS ARG_UNPARSED_ARGUMENTS)
    cmake_path(GET file PARENT_PATH folder)
    cmake_path(GET file STEM LAST_ONLY stem)
    cmake_path(GET file EXTENSION LAST_ONLY extension)
    if(ARG_SUFFIX)
      string(APPEND stem _${ARG_SUFFIX})
    endif()
    set(base ${generated}/${folder}/${stem}${extension})
    string(MAKE_C_IDENTIFIER "${stem}${extension}" symbol)
    file(MAKE_DIRECTORY ${generated}/${folder})
    add_custom_command(
      OUTPUT ${base}.cpp ${base}.h
      BYPRODUCTS ${base}.spv
      COMMAND Vulkan::glslc --target-env=vulkan1.3 ${optimise} -Werror -I ${CMAKE_SOURCE_DIR} ${ARG_DEFINES}
        -MD -MF ${base}.d -MT ${base}.cpp -o ${base}.spv ${CMAKE_SOURCE_DIR}/${file}
      COMMAND ${TESSERA_SPIRV_VAL} --target-env vulkan1.3 --scalar-block-layout ${base}.spv
      COMMAND ${CMAKE_COMMAND} -D SPIRV=${base}.spv -D BASE=${base} -D INCLUDE=${folder}/${stem}${extension}.h
        -D SYMBOL=${symbol} -P ${CMAKE_SOURCE_DIR}/deploy/cmake/embed_words.cmake
      DEPENDS ${CMAKE_SOURCE_DIR}/${file} ${CMAKE_SOURCE_DIR}/deploy/cmake/embed_words.cmake
      DEPFILE ${base}.d
      COMMENT "Shader ${folder}/${stem}${extension}"
      VERBATIM)
    target_sources(${target} PRIVATE ${base}.cpp ${base}.h)
    target_include_directories(${target} PRIVATE ${generated})
  endforeach()
endfunction()
