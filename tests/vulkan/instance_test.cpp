#include "backends/vulkan/device/instance.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

#include "backends/vulkan/device/device_list.h"

namespace tessera::vulkan {

namespace {

std::set<std::string> loaded_libraries() {
    std::set<std::string> libraries;
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        const std::size_t path = line.find('/');
        if (path != std::string::npos && line.find(".so", path) != std::string::npos) {
            libraries.insert(line.substr(path));
        }
    }
    return libraries;
}

// Some drivers cannot be loaded arbitrarily often.
TEST(Instance, LeavesDriversLoaded) {
    std::set<std::string> used;
    {
        const Instance instance;
        (void)list_devices(instance);
        used = loaded_libraries();
    }
    const std::set<std::string> left = loaded_libraries();
    for (const std::string& library : used) EXPECT_TRUE(left.contains(library)) << library;
}

TEST(Instance, CanBeCreatedAnyNumberOfTimes) {
    for (int i = 0; i < 100; ++i) {
        const Instance instance;
        ASSERT_FALSE(list_devices(instance).empty()) << "after " << i;
    }
}

}  // namespace

}  // namespace tessera::vulkan
