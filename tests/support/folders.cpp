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

std::filesystem::path open_image_denoise(const std::string& stand_in) {
    return std::filesystem::path(BUILD_FOLDER) / "tests" / stand_in;
}

}  // namespace tessera::test
