// Every shared function gives the same in C++ and in a shader, within the bounds of functions.inc.
#include <cstdio>

#include "tests/shading/difference.h"
#include "tests/shading/evaluation.h"
#include "tests/shading/inputs.h"
#include "tests/shading/shading.comp.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::shading {
namespace {

constexpr std::size_t Count = 20'000;
constexpr uint GroupSize = 64;

// Both layouts are scalar: nothing may be padded.
static_assert(sizeof(Inputs) == 4 * (2 + 2 + 3 * 5 + 5 + 4 + 2 + 4));
static_assert(sizeof(Outputs) == 4 * (24 + 3));

struct Arguments {
    std::uint64_t inputs, outputs;
    std::uint32_t count, padding;
};

std::vector<Outputs> evaluated(Evaluate& evaluate, uint function, const std::vector<Inputs>& inputs) {
    std::vector<Outputs> outputs(inputs.size());
    evaluate(function, inputs.data(), outputs.data(), inputs.size());
    return outputs;
}

// Prints what it finds, so that a bound can be chosen and watched.
void expect_within(double bound, const SharedFunction& function, const char* set,
                   const Difference& difference) {
    std::printf("%10.2f of %-6g %-9s %s\n", difference.ulp, bound, set, function.call.c_str());
    EXPECT_LE(difference.ulp, bound) << function.call << ", input " << difference.input << " of " << set
                                     << ":" << difference.values;
}

// `other(function)` gives what evaluates a function on the other side.
template <class Other>
void compare_all(const Other& other) {
    const std::vector<Inputs> ordinary = make_inputs(InputSet::Ordinary, Count);
    const std::vector<Inputs> edges = make_inputs(InputSet::Edges, Count);
    const std::vector<SharedFunction> functions = shared_functions();
    for (uint i = 0; i < functions.size(); ++i) {
        const auto evaluate = other(i);
        const auto difference = [&](const std::vector<Inputs>& inputs) {
            return largest_difference(evaluated(evaluate_plain, i, inputs), evaluate(inputs));
        };
        expect_within(functions[i].ordinary, functions[i], "ordinary", difference(ordinary));
        expect_within(functions[i].edges, functions[i], "edges", difference(edges));
    }
}

class SharedShading : public vulkan::VulkanTest {};

TEST_F(SharedShading, IsTheSameInAShader) {
    using namespace vulkan;
    compare_all([&](uint function) {
        auto kernel = std::make_shared<ComputePipeline>(
            device(), PipelineSettings{.name = "shared shading",
                                       .code = shaders::shading_comp(),
                                       .constants = {{0, function}},
                                       .push_bytes = sizeof(shading::Arguments)});
        return [this, kernel](const std::vector<Inputs>& inputs) {
            const Buffer from = make_buffer(device(), inputs);
            const Buffer to(device(), inputs.size() * sizeof(Outputs));
            const auto count = uint(inputs.size());
            run(device(), {.pipeline = kernel.get(),
                           .arguments = shading::Arguments{from.address(), to.address(), count, 0},
                           .groups = {(count + GroupSize - 1) / GroupSize},
                           .writes = {&to}});
            return download<Outputs>(device(), to);
        };
    });
}

// Not every device is at hand: this is how far contraction alone takes one.
TEST(SharedShadingContracted, StaysWithinTheBounds) {
    compare_all([](uint function) {
        return [function](const std::vector<Inputs>& inputs) {
            return evaluated(evaluate_contracted, function, inputs);
        };
    });
}

}  // namespace
}  // namespace tessera::shading
