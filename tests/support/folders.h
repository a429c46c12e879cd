#pragma once

#include <filesystem>

// Where the tree and its programs lie. Nothing else knows, so that no other object depends on it and a compiler cache
// serves every checkout.
namespace tessera::test {

std::filesystem::path source_folder();
std::filesystem::path scenes_folder();    // tests/scenes
std::filesystem::path programs_folder();  // bin of the build
std::filesystem::path python_package();   // to be put on PYTHONPATH

}  // namespace tessera::test
