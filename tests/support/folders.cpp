#include "tests/support/folders.h"

namespace tessera::test {

std::filesystem::path source_folder() {
    return SOURCE_FOLDER;
}
std::filesystem::path scenes_folder() {
    return source_folder() / "tests/scenes";
}
std::filesystem::path programs_folder() {
    return std::filesystem::path(BUILD_FOLDER) / "bin";
}
std::filesystem::path python_package() {
    return std::filesystem::path(BUILD_FOLDER) / "python";
}

}  // namespace tessera::test
