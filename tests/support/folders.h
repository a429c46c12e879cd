#pragma once

#include <filesystem>
#include <string>

// The folders of the source tree and its programs. Kept in one object, so that a compiler cache works for every checkout.
namespace tessera::test {

std::filesystem::path source_folder();
std::filesystem::path scenes_folder();    // tests/scenes
std::filesystem::path programs_folder();  // bin of the build
std::filesystem::path python_package();   // to be put on PYTHONPATH
std::filesystem::path open_image_denoise(
    const std::string& stand_in = "oidn");  // of tests/oidn, for LD_LIBRARY_PATH

}  // namespace tessera::test
