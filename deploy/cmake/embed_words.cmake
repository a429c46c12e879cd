# Writes BASE.h and BASE.cpp: the 32-bit words of the file SPIRV as a function SYMBOL. INCLUDE names BASE.h.
file(READ ${SPIRV} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
string(REGEX REPLACE "((0x........,)(0x........,)(0x........,)(0x........,)(0x........,)(0x........,)(0x........,)(0x........,))"
  "\\1\n" words "${words}")
file(WRITE ${BASE}.h "#pragma once

#include <cstdint>
#include <span>

namespace tessera::vulkan::shaders {
std::span<const std::uint32_t> ${SYMBOL}();
}
")
file(WRITE ${BASE}.cpp "#include \"${INCLUDE}\"

namespace tessera::vulkan::shaders {
std::span<const std::uint32_t> ${SYMBOL}() {
static constexpr std::uint32_t Words[] = {
${words}
};
return Words;
}
}
")
