#include <gtest/gtest.h>

#include <algorithm>

#include "client/tools/vulkan_devices.h"

namespace tessera::tools {

namespace {

const Fact* find_fact(const Diagnostic& diagnostic, const std::string& key) {
    const auto found = std::find_if(diagnostic.facts.begin(), diagnostic.facts.end(),
                                    [&](const Fact& fact) { return fact.key == key; });
    return found != diagnostic.facts.end() ? &*found : nullptr;
}

TEST(Doctor, ListsVulkanDevicesWithWhatTheySupport) {
    Diagnostics diagnostics;
    examine_vulkan(diagnostics);
    ASSERT_FALSE(diagnostics.empty());
    const auto usable =
        std::find_if(diagnostics.begin(), diagnostics.end(),
                     [](const Diagnostic& diagnostic) { return diagnostic.severity == Severity::Ok; });
    ASSERT_NE(usable, diagnostics.end()) << "a software device is enough: " << diagnostics.front().remedy;
    EXPECT_TRUE(usable->subject.starts_with("Vulkan device ")) << usable->subject;
    EXPECT_TRUE(usable->remedy.empty()) << usable->remedy;
    for (const char* number : {"subgroup_size", "memory_bytes", "shared_memory_bytes"}) {
        const Fact* fact = find_fact(*usable, number);
        ASSERT_NE(fact, nullptr) << number;
        EXPECT_GT(std::get<std::uint64_t>(fact->value), 0u) << number;
    }
    const Fact* ray_query = find_fact(*usable, "ray_query");
    ASSERT_NE(ray_query, nullptr);
    EXPECT_TRUE(std::holds_alternative<bool>(ray_query->value));
}

TEST(Diagnostics, FormatsByteCounts) {
    EXPECT_EQ(byte_text(0), "0 B");
    EXPECT_EQ(byte_text(1023), "1023 B");
    EXPECT_EQ(byte_text(32 << 10), "32.0 KiB");
    EXPECT_EQ(byte_text(3ull << 29), "1.5 GiB");
}

}  // namespace

}  // namespace tessera::tools
