#include "tests/vulkan/vulkan_test.h"

#include <cstdlib>
#include <string_view>

namespace tessera::vulkan {

namespace {

std::string_view environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

}  // namespace

Validation wanted_validation() {
    return environment("TESSERA_TEST_VALIDATION") == "instrumented" ? Validation::Instrumented
                                                                    : Validation::Calls;
}

std::uint64_t slack_for(Validation validation) {
    return validation == Validation::Instrumented ? 256 : 0;  // more than the padding of any struct
}

void VulkanTest::SetUp() {
    try {
        reopen({.buffer_slack = slack_for(wanted_validation())}, wanted_validation());
    } catch (const Error& error) {
        FAIL() << "this test needs a Vulkan device, and a software device is enough: " << error.what();
    }
}

void VulkanTest::TearDown() {
    close();
    if (instance_ == nullptr) return;
    for (const Message& message : instance_->take_messages()) {
        ADD_FAILURE() << "validation: " << message.id << "\n" << message.text;
    }
}

bool VulkanTest::is_instrumented() const {
    return wanted_validation() == Validation::Instrumented;
}

void VulkanTest::close() {
    device_.reset();
}

void VulkanTest::reopen(const DeviceSettings& settings) {
    close();
    const std::vector<DeviceInfo> devices = list_devices(*instance_);
    const DeviceInfo& chosen = choose_device(devices, environment("TESSERA_TEST_DEVICE"));
    device_ = std::make_unique<Device>(*instance_, chosen, settings);
}

void VulkanTest::reopen(const DeviceSettings& settings, Validation validation) {
    TearDown();
    instance_ = std::make_unique<Instance>(validation);
    reopen(settings);
}

}  // namespace tessera::vulkan
