#include <gtest/gtest.h>

#include <algorithm>

#include "client/tools/vulkan_devices.h"

namespace tessera::tools {

namespace {

const Fact* find_fact(const Finding& finding, const std::string& key) {
    const auto found = std::find_if(finding.facts.begin(), finding.facts.end(),
                                    [&](const Fact& fact) { return fact.key == key; });
    return found != finding.facts.end() ? &*found : nullptr;
}

TEST(Doctor, ListsVulkanDevicesWithWhatTheySupport) {
    Findings findings;
    examine_vulkan(findings);
    ASSERT_FALSE(findings.empty());
    const auto usable = std::find_if(findings.begin(), findings.end(),
                                     [](const Finding& finding) { return finding.verdict == Verdict::Good; });
    ASSERT_NE(usable, findings.end()) << "a software device is enough: " << findings.front().remedy;
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

TEST(Findings, WriteBytesForPeople) {
    EXPECT_EQ(byte_text(0), "0 B");
    EXPECT_EQ(byte_text(1023), "1023 B");
    EXPECT_EQ(byte_text(32 << 10), "32.0 KiB");
    EXPECT_EQ(byte_text(3ull << 29), "1.5 GiB");
}

}  // namespace

}  // namespace tessera::tools
