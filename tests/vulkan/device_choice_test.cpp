#include <gtest/gtest.h>

#include "backends/vulkan/device/device_list.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

namespace {

std::vector<DeviceInfo> some_devices() {
    return {{.index = 0, .name = "llvmpipe (LLVM 15.0.6)", .kind = DeviceKind::Cpu},
            {.index = 1, .name = "Old Card 7", .kind = DeviceKind::Discrete, .refused = {"no shaderInt64"}},
            {.index = 2, .name = "Small Chip", .kind = DeviceKind::Integrated},
            {.index = 3, .name = "Great Card", .kind = DeviceKind::Discrete},
            {.index = 4, .name = "Great Card", .kind = DeviceKind::Discrete}};
}

std::string failure_text(std::span<const DeviceInfo> devices, std::string_view wanted, ErrorCode code) {
    try {
        choose_device(devices, wanted);
    } catch (const Error& error) {
        EXPECT_EQ(int(error.code()), int(code));
        return error.what();
    }
    ADD_FAILURE() << "'" << wanted << "' means a device";
    return "";
}

TEST(DeviceChoice, PicksTheBestUsableDevice) {
    std::vector<DeviceInfo> devices = some_devices();
    EXPECT_EQ(choose_device(devices, "").index, 3u);
    for (const std::uint32_t expected : {4u, 2u, 0u}) {
        std::erase_if(devices, [&](const DeviceInfo& device) {
            return device.index == choose_device(devices, "").index;
        });
        EXPECT_EQ(choose_device(devices, "").index, expected);
    }
}

TEST(DeviceChoice, AcceptsAnIndexOrPartOfAName) {
    const std::vector<DeviceInfo> devices = some_devices();
    EXPECT_EQ(choose_device(devices, "0").index, 0u);
    EXPECT_EQ(choose_device(devices, "4").index, 4u);
    EXPECT_EQ(choose_device(devices, "LLVM").index, 0u);
    EXPECT_EQ(choose_device(devices, "small c").index, 2u);
    EXPECT_EQ(choose_device(devices, "card").index, 3u);
}

TEST(DeviceChoice, ErrorsListDevicesAndReasons) {
    const std::vector<DeviceInfo> devices = some_devices();
    for (const char* wanted : {"9", "old card", "1", "nothing"}) {
        const std::string text = failure_text(devices, wanted, ErrorCode::InvalidInput);
        EXPECT_NE(text.find("'" + std::string(wanted) + "'"), std::string::npos) << text;
        EXPECT_NE(text.find("1 = Old Card 7 (discrete GPU), refused: no shaderInt64; 2 = "),
                  std::string::npos)
            << text;
    }
    failure_text(std::span(devices).subspan(1, 1), "", ErrorCode::Unavailable);
    EXPECT_NE(failure_text({}, "", ErrorCode::Unavailable).find("install"), std::string::npos);
}

TEST(Results, ErrorsNameTheResult) {
    EXPECT_NO_THROW(check(VK_SUCCESS, "do it"));
    EXPECT_THROW(check(VK_ERROR_DEVICE_LOST, "submit"), DeviceLost);
    try {
        check(VK_ERROR_OUT_OF_DEVICE_MEMORY, "create a buffer");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(int(error.code()), int(ErrorCode::OutOfMemory));
        EXPECT_TRUE(std::string(error.what()).starts_with("cannot create a buffer: VK_ERROR_OUT_OF_DEVICE"));
    }
    EXPECT_EQ(result_name(static_cast<VkResult>(-77)), "VkResult -77");
}

}  // namespace

}  // namespace tessera::vulkan
