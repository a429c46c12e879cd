// Every shared function returns the same in C++ and in a shader, within the bounds of functions/*.inc.
#include <immintrin.h>

#include <cstdio>
#include <cstring>
#include <memory>

#include "tests/shading/difference.h"
#include "tests/shading/evaluation.h"
#include "tests/shading/inputs.h"
#include "tests/shading/shading_branches.comp.h"
#include "tests/shading/shading_found.comp.h"
#include "tests/shading/shading_lights.comp.h"
#include "tests/shading/shading_lobes.comp.h"
#include "tests/shading/shading_materials.comp.h"
#include "tests/shading/shading_media.comp.h"
#include "tests/shading/shading_numbers.comp.h"
#include "tests/shading/shading_samples.comp.h"
#include "tests/shading/shading_steps.comp.h"
#include "tests/shading/shading_surface_shaders.comp.h"
#include "tests/shading/shading_surfaces.comp.h"
#include "tests/shading/shading_textures.comp.h"
#include "tests/shading/shading_views.comp.h"
#include "tests/shading/test_scene_builder.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::shading {
namespace {

constexpr std::size_t Count = 8'000, AtOnce = 2'000;  // inputs of each set
constexpr uint GroupSize = 64;

// Scalar layout pads nothing.
static_assert(sizeof(Inputs) == 4 * (3 * 2 + 6 * 3 + 12 + 5));
static_assert(sizeof(Outputs) == 4 * (64 + 1 + 4));

// Evaluates one list: all results of the first function, then of the next.
class Side {
  public:
    virtual ~Side() = default;
    virtual void evaluate(std::span<const Inputs> inputs, std::span<Outputs> outputs) = 0;
};

// Denormal numbers count as 0, as on many devices.
class FlushingToZero {
  public:
    FlushingToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | FlushResults | ZeroArguments); }
    ~FlushingToZero() { _mm_setcsr(before_); }
    FlushingToZero(const FlushingToZero&) = delete;
    FlushingToZero& operator=(const FlushingToZero&) = delete;

  private:
    static constexpr unsigned FlushResults = 0x8000, ZeroArguments = 0x0040;
    unsigned before_;
};

class Host : public Side {
  public:
    Host(Evaluate& function, std::uint32_t list) : function_(function), list_(list) {
        const std::size_t size = make_test_scene(0).bytes.size();
        memory_ = std::make_unique<std::byte[]>(size);
        const PackedTestScene packed = make_test_scene(reinterpret_cast<std::uint64_t>(memory_.get()));
        std::memcpy(memory_.get(), packed.bytes.data(), size);
        test_scene_ = packed.test_scene;
    }
    void evaluate(std::span<const Inputs> inputs, std::span<Outputs> outputs) override {
        function_(list_, &test_scene_, inputs.data(), inputs.size(), outputs.data());
    }

  private:
    Evaluate& function_;
    std::uint32_t list_;
    std::unique_ptr<std::byte[]> memory_;
    TestScene test_scene_{};
};

// As a device may calculate where functions are not PRECISE.
class ContractingHost final : public Host {
  public:
    explicit ContractingHost(std::uint32_t list) : Host(evaluate_contracted, list) {}
    void evaluate(std::span<const Inputs> inputs, std::span<Outputs> outputs) override {
        const FlushingToZero flushing;
        Host::evaluate(inputs, outputs);
    }
};

std::span<const std::uint32_t> shader_of(std::uint32_t list) {
    using namespace vulkan::shaders;
    using Words = std::span<const std::uint32_t>();
    constexpr Words* Shaders[FunctionListCount] = {
        shading_numbers_comp, shading_lobes_comp,           shading_textures_comp, shading_surfaces_comp,
        shading_lights_comp,  shading_found_comp,           shading_steps_comp,    shading_branches_comp,
        shading_samples_comp, shading_surface_shaders_comp, shading_views_comp,    shading_materials_comp,
        shading_media_comp};
    return Shaders[list]();
}

class ShaderSide final : public Side {
  public:
    ShaderSide(vulkan::Device& device, std::uint32_t list, std::size_t functions)
        : device_(device),
          kernel_(device,
                  {.name = "shared shading", .code = shader_of(list), .push_bytes = sizeof(Arguments)}),
          memory_(device, make_test_scene(0).bytes.size()),
          from_(device, AtOnce * sizeof(Inputs)),
          to_(device, functions * AtOnce * sizeof(Outputs)) {
        const PackedTestScene packed = make_test_scene(memory_.address());
        vulkan::upload(device, memory_, packed.bytes);
        test_scene_ = packed.test_scene;
    }
    void evaluate(std::span<const Inputs> inputs, std::span<Outputs> outputs) override {
        const auto count = uint(inputs.size());
        vulkan::upload_bytes(device_, from_, std::as_bytes(inputs));
        vulkan::run(device_, {.pipeline = &kernel_,
                              .arguments = Arguments{test_scene_, from_.address(), to_.address(), count, 0},
                              .groups = {(count + GroupSize - 1) / GroupSize},
                              .writes = {&to_}});
        vulkan::download_bytes(device_, to_, std::as_writable_bytes(outputs));
    }

  private:
    struct Arguments {
        TestScene test_scene;
        std::uint64_t inputs, outputs;
        std::uint32_t count, padding;
    };

    vulkan::Device& device_;
    vulkan::ComputePipeline kernel_;
    vulkan::Buffer memory_, from_, to_;
    TestScene test_scene_{};
};

// Prints the differences, so that bounds can be chosen and monitored.
void compare(std::uint32_t list, InputSet set, Side& one, Side& other) {
    const std::vector<SharedFunction> functions = functions_of(list);
    const std::vector<Inputs> inputs = make_inputs(set, Count);
    std::vector<std::vector<Outputs>> a(functions.size()), b(functions.size());
    std::vector<Outputs> some(functions.size() * AtOnce);
    for (std::size_t first = 0; first < Count; first += AtOnce) {
        const auto part = std::span(inputs).subspan(first, AtOnce);
        for (auto [side, results] : {std::pair(&one, &a), std::pair(&other, &b)}) {
            side->evaluate(part, some);
            for (std::size_t i = 0; i < functions.size(); ++i) {
                const auto begin = some.begin() + static_cast<std::ptrdiff_t>(i * AtOnce);
                (*results)[i].insert((*results)[i].end(), begin, begin + AtOnce);
            }
        }
    }
    const char* name = set == InputSet::Ordinary ? "ordinary" : "edges";
    for (std::size_t i = 0; i < functions.size(); ++i) {
        const SharedFunction& function = functions[i];
        const double bound = set == InputSet::Ordinary ? function.ordinary : function.edges;
        const std::size_t outside = Count / (set == InputSet::Ordinary ? 200 : 50);
        const Difference found = largest_difference(a[i], b[i], function.decides ? outside : 0);
        std::printf("%10.2f of %-6g %-9s %s\n", found.ulp, bound, name, function.call.c_str());
        EXPECT_LE(found.ulp, bound) << function.call << ", input " << found.input << " of " << name << ":"
                                    << found.values << "; " << count_beyond(a[i], b[i], bound) << " of "
                                    << Count << " inputs are beyond the bound";
    }
}

void compare(std::uint32_t list, Side& one, Side& other) {
    for (const InputSet set : {InputSet::Ordinary, InputSet::Edges}) compare(list, set, one, other);
}

class SharedShading : public vulkan::VulkanTest, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(SharedShading, MatchesAShader) {
    Host host(evaluate_plain, GetParam());
    ShaderSide shader(device(), GetParam(), functions_of(GetParam()).size());
    compare(GetParam(), host, shader);
}

// Simulates devices that contract and flush: the differences by that alone.
TEST_P(SharedShading, StaysWithinTheBoundsWhenContracted) {
    Host host(evaluate_plain, GetParam());
    ContractingHost contracting(GetParam());
    compare(GetParam(), host, contracting);
}

INSTANTIATE_TEST_SUITE_P(Lists, SharedShading, testing::Range(0u, FunctionListCount),
                         [](const auto& list) { return FunctionLists[list.param]; });

}  // namespace
}  // namespace tessera::shading
