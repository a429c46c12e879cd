#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/device/transfer.h"

namespace tessera::vulkan {

// The validation that the tests use: Calls, or the value of TESSERA_TEST_VALIDATION.
Validation wanted_validation();
// DeviceSettings::buffer_slack for it.
std::uint64_t slack_for(Validation validation);

// A fixture with an opened device under the validation layer. Any message of the layer fails the test, and so
// does a machine without a device. Buffers and pipelines are created inside the test. For example:
//
//     tests/.../CMakeLists.txt:
//         tessera_test(twice_test LABELS vulkan SOURCES twice_test.cpp LIBS tessera_vulkan_fixture)
//         tessera_shaders(twice_test tests/vulkan/twice.comp)
//
//     tests/vulkan/twice.comp:
//         #version 460
//         #extension GL_EXT_buffer_reference : require
//         #extension GL_EXT_scalar_block_layout : require
//         layout(local_size_x = 64) in;
//         layout(buffer_reference, scalar) buffer Numbers { float at[]; };
//         layout(push_constant, scalar) uniform Arguments { Numbers numbers; uint count; };
//         void main() {
//             if (gl_GlobalInvocationID.x < count) numbers.at[gl_GlobalInvocationID.x] *= 2;
//         }
//
//     twice_test.cpp:
//         #include "tests/vulkan/twice.comp.h"
//         #include "tests/vulkan/vulkan_test.h"
//         using Twice = VulkanTest;
//         struct Arguments { std::uint64_t numbers; std::uint32_t count; };
//         TEST_F(Twice, Doubles) {
//             const Buffer numbers = make_buffer(device(), std::vector<float>{1, 2, 3});
//             const ComputePipeline twice(
//                 device(), {.name = "twice", .code = shaders::twice_comp(), .push_bytes = sizeof(Arguments)});
//             run(device(), {.pipeline = &twice,
//                            .arguments = Arguments{numbers.address(), 3},
//                            .groups = {1},
//                            .writes = {&numbers}});
//             EXPECT_EQ(download<float>(device(), numbers), (std::vector<float>{2, 4, 6}));
//         }
//
// TESSERA_TEST_DEVICE chooses the device as --device does; TESSERA_TEST_VALIDATION=instrumented turns
// GPU-assisted validation on. Under it, lavapipe 22.3 skipped work in a workgroup of one invocation:
// keep workgroups at least as large as a subgroup.
class VulkanTest : public testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;

    Device& device() { return *device_; }
    Instance& instance() { return *instance_; }
    std::vector<Message> take_messages() {
        return instance_->take_messages();
    }  // these then do not fail the test

    bool is_instrumented() const;

    // All buffers and pipelines must be destroyed before.
    void reopen(const DeviceSettings& settings);
    void reopen(const DeviceSettings& settings, Validation validation);
    void close();

  private:
    std::unique_ptr<Instance> instance_;
    std::unique_ptr<Device> device_;
};

}  // namespace tessera::vulkan
