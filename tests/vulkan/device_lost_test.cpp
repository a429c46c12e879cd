#include <atomic>

#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

using Words = std::vector<std::uint32_t>;

// Loses the device at the n-th call of a kind.
FaultHook lose_at(FaultPoint where, int call) {
    return [where, left = std::make_shared<std::atomic<int>>(call)](FaultPoint point) {
        return point == where && --*left == 0 ? VK_ERROR_DEVICE_LOST : VK_SUCCESS;
    };
}

using DeviceLostTest = VulkanTest;

TEST_F(DeviceLostTest, AFailedSubmissionThrowsDeviceLostAndANewDeviceWorks) {
    reopen({.fault = lose_at(FaultPoint::Submit, 3)});
    {
        const Buffer numbers(device(), 1024);
        const Fill fill{&numbers, 0, 1024, 5};
        device().queue().submit(fill);
        device().queue().submit(fill);
        EXPECT_THROW(device().queue().submit(fill), DeviceLost);
        EXPECT_THROW(device().queue().submit(fill), DeviceLost) << "a lost device stays lost";
        EXPECT_THROW(download<std::uint32_t>(device(), numbers), DeviceLost);
    }
    reopen({});
    const Buffer numbers(device(), 1024);
    device().queue().submit(Fill{&numbers, 0, 1024, 5});
    EXPECT_EQ(download<std::uint32_t>(device(), numbers), Words(256, 5));
}

TEST_F(DeviceLostTest, AFailedWaitThrowsDeviceLostAndBuffersCanBeDestroyed) {
    reopen({.fault = lose_at(FaultPoint::Wait, 2)});
    Buffer numbers(device(), 1024);
    const Submission first = device().queue().submit(Fill{&numbers, 0, 1024, 5});
    EXPECT_NO_THROW(first.wait());
    const Submission second = device().queue().submit(Fill{&numbers, 0, 1024, 6});
    EXPECT_THROW(second.wait(), DeviceLost);
    EXPECT_THROW(second.done(), DeviceLost);
    numbers = Buffer();
}

// Other failures are recoverable: the barrier plan is reset, and the device stays usable.
TEST_F(DeviceLostTest, OtherSubmissionErrorsDoNotLoseTheDevice) {
    reopen({.fault = [left = std::make_shared<std::atomic<int>>(2)](FaultPoint point) {
        return point == FaultPoint::Submit && --*left == 0 ? VK_ERROR_OUT_OF_HOST_MEMORY : VK_SUCCESS;
    }});
    const Buffer a(device(), 1024), b(device(), 1024);
    device().queue().submit(Fill{&a, 0, 1024, 5});
    EXPECT_THROW(device().queue().submit(Fill{&a, 0, 1024, 6}), Error);
    device().queue().submit(Copy{&a, &b, 0, 0, 1024});
    EXPECT_EQ(download<std::uint32_t>(device(), b), Words(256, 5));
}

}  // namespace

}  // namespace tessera::vulkan
