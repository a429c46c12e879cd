#include "tests/vulkan/vulkan_test.h"

#include <cstdlib>
#include <string_view>

namespace tessera::vulkan {

namespace {

std::string_view environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

Validation wanted_validation() {
    return environment("TESSERA_TEST_VALIDATION") == "instrumented" ? Validation::Instrumented
                                                                    : Validation::Calls;
}

}  // namespace

void VulkanTest::SetUp() {
    try {
        instance_ = std::make_unique<Instance>(wanted_validation());
        reopen();
    } catch (const Error& error) {
        FAIL() << "this test needs a Vulkan device, and a software device is enough: " << error.what();
    }
}

void VulkanTest::TearDown() {
    device_.reset();
    if (instance_ == nullptr) return;
    for (const Message& message : instance_->take_messages()) {
        ADD_FAILURE() << "validation: " << message.id << "\n" << message.text;
    }
}

void VulkanTest::reopen() {
    device_.reset();
    const std::vector<DeviceInfo> devices = list_devices(*instance_);
    device_ =
        std::make_unique<Device>(*instance_, choose_device(devices, environment("TESSERA_TEST_DEVICE")));
}

}  // namespace tessera::vulkan
