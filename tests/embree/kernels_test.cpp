// Kernels compiled for some features compute the same bits as the kernel with all features.
#include <cstring>
#include <functional>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

const std::vector<const Kernel*> Kernels{&PlainKernel,  &LightsKernel, &CoatedKernel,
                                         &GlassKernel,  &FilmKernel,   &ShaderKernel,
                                         &MovingKernel, &FoggyKernel,  &FullKernel};

// Perfect speculars, colours, alpha, most kinds of lights, an environment.
void add_plain(Model& model) {
    model.floor(model.material(chalk(glm::vec3(0.7f))), 3.0f, -1.0f);
    scene::Material veil = chalk({0.2f, 0.8f, 0.3f});
    veil.base_color.w = 0.5f;
    veil.alpha_mode = scene::AlphaMode::Blend;
    model.quad(model.material(veil), {{{-1, -1, 1}, {0, -1, 1}, {0, 0, 1}, {-1, 0, 1}}});
    model.sphere(model.material(glass(1.5f)), {0.8, 0, 0}, 0.6, Normals::Smooth);
    model.sphere(model.material(mirror(glm::vec3(0.9f))), {-0.8, 0.4, 0}, 0.5, Normals::Smooth);
    model.sphere(
        model.material({.base_color = {0.9f, 0.4f, 0.2f, 1.0f}, .metallic = 0.5f, .roughness = 0.3f}),
        {0, -0.9, 0}, 0.4, Normals::Smooth);
    model.floor(model.material(lamp(4.0f)), -0.3f, 3.0f);
    model.point_light({1, 2, 2}, 5.0f);
    model.light({.kind = scene::LightKind::Directional, .angle = 0.1f}, glm::dmat4(1.0));
    model.sky(glm::vec3(0.2f, 0.3f, 0.5f));
}

void add_coat(Model& model) {
    add_plain(model);
    model.sphere(model.material({.roughness = 0.5f, .clearcoat = 0.8f, .clearcoat_roughness = 0.1f}),
                 {0.2, 0.9, 0}, 0.4, Normals::Smooth);
}

void add_sheen(Model& model) {
    add_coat(model);
    model.sphere(model.material({.roughness = 0.6f, .sheen_color = glm::vec3(0.5f), .sheen_roughness = 0.4f}),
                 {-0.2, 0.9, 0.3}, 0.3, Normals::Smooth);
}

void add_frosted(Model& model) {
    add_plain(model);
    scene::Material frosted = glass(1.3f);
    frosted.roughness = 0.4f;
    frosted.attenuation_color = {0.5f, 0.8f, 0.9f};
    frosted.attenuation_distance = 0.3f;
    model.sphere(model.material(frosted), {-1.2, -0.9, 0.3}, 0.3, Normals::Smooth);
}

void add_film(Model& model) {
    add_plain(model);
    model.sphere(model.material({.roughness = 0.4f, .iridescence = 0.7f}), {0.2, 0.9, 0}, 0.4,
                 Normals::Smooth);
    scene::Material bubble = glass(1.3f);
    bubble.iridescence = 1.0f;
    model.sphere(model.material(bubble), {-1.2, -0.9, 0.3}, 0.3, Normals::Smooth);
}

void add_moving(Model& model) {
    add_plain(model);
    model.moves({glm::translate(glm::dmat4(1.0), {0.3, 0.0, 0.0})});
    model.sphere(model.material(chalk(glm::vec3(0.9f))), {1.2, -0.9, 0.3}, 0.3);
}

void add_fog(Model& model) {
    add_plain(model);
    model.set_medium({.absorption = glm::vec3(0.1f), .scattering = glm::vec3(0.2f)});
    model.box(ObjectId{}, {-2.5f, -2.5f, -0.9f}, {2.5f, 2.5f, 2.5f});
    model.clear_medium();
}

void add_lights(Model& model) {
    add_plain(model);
    model.light({.kind = scene::LightKind::Sphere, .radius = 0.2f},
                glm::translate(glm::dmat4(1.0), {-1.5, 1.0, 1.0}));
    model.light({.kind = scene::LightKind::Quad}, glm::translate(glm::dmat4(1.0), {1.5, 1.0, 1.0}));
    model.floor(model.material({.shadow_catcher = true}), 6.0f, -1.5f);
}

void add_shader(Model& model) {
    add_lights(model);
    model.sphere(model.shader({.specular = glm::vec3(0.3f), .reflection = glm::vec3(0.2f)}), {0.2, 0.9, 0},
                 0.4, Normals::Smooth);
}

void add_all(Model& model) {
    add_shader(model);
    add_coat(model);
    model.sphere(model.material({.roughness = 0.6f, .sheen_color = glm::vec3(0.5f), .sheen_roughness = 0.4f}),
                 {-0.2, 0.9, 0.3}, 0.3, Normals::Smooth);
    scene::Material frosted = glass(1.3f);
    frosted.roughness = 0.4f;
    model.sphere(model.material(frosted), {-1.2, -0.9, 0.3}, 0.3, Normals::Smooth);
    model.moves({glm::translate(glm::dmat4(1.0), {0.3, 0.0, 0.0})});
    model.sphere(model.material(chalk(glm::vec3(0.9f))), {1.2, -0.9, 0.3}, 0.3);
}

std::vector<PathSample> samples(const SceneAdapter& adapter, const view::View& view, const Kernel* kernel) {
    PathTracer tracer(adapter.tables(), adapter.scene(), view);
    if (kernel != nullptr) tracer.set_kernel(*kernel);
    std::vector<PathSample> found;
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < 4; ++sample) {
        for (std::uint32_t i = 0; i < view.width * view.height; ++i) {
            found.push_back(tracer.trace(i % view.width, i / view.width, sample, rays));
        }
    }
    return found;
}

std::vector<PathSample> samples_with_path_log(const SceneAdapter& adapter, const view::View& view) {
    const PathTracer tracer(adapter.tables(), adapter.scene(), view);
    std::vector<PathSample> found;
    std::vector<std::string> path_log;
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < 4; ++sample) {
        for (std::uint32_t i = 0; i < view.width * view.height; ++i) {
            found.push_back(tracer.trace(i % view.width, i / view.width, sample, rays, &path_log));
        }
    }
    return found;
}

bool same_bits(const std::vector<PathSample>& a, const std::vector<PathSample>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(PathSample)) == 0;
}

struct KernelCase {
    const char* name;
    void (*add)(Model& model);
    const Kernel* chosen;
};

class KernelsTest : public testing::TestWithParam<KernelCase> {};

TEST_P(KernelsTest, AllSupportingKernelsComputeTheSameBits) {
    Model model;
    GetParam().add(model);
    const SceneAdapter& adapter = model.build();
    for (const auto renderer :
         {view::Renderer::PathTracing, view::Renderer::Whitted, view::Renderer::Coverage}) {
        view::View view = small_view({0, 0, 4}, 0.9, 32);
        view.renderer = renderer;
        view.channels = frame::ChannelSet::all();
        const PathTracer tracer(adapter.tables(), adapter.scene(), view);
        EXPECT_EQ(&tracer.kernel(), GetParam().chosen);
        const std::vector<PathSample> all = samples(adapter, view, &FullKernel);
        for (const Kernel* kernel : Kernels) {
            if ((adapter.tables().scene.features & ~kernel->features) != 0) continue;
            EXPECT_TRUE(same_bits(samples(adapter, view, kernel), all))
                << "features " << kernel->features << ", renderer " << static_cast<int>(renderer);
        }
        EXPECT_TRUE(same_bits(samples_with_path_log(adapter, view), all));
    }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, KernelsTest,
    testing::Values(KernelCase{"Plain", add_plain, &PlainKernel}, KernelCase{"Coat", add_coat, &CoatedKernel},
                    KernelCase{"Lights", add_lights, &LightsKernel},
                    KernelCase{"Sheen", add_sheen, &CoatedKernel},
                    KernelCase{"Glass", add_frosted, &GlassKernel}, KernelCase{"Film", add_film, &FilmKernel},
                    KernelCase{"Shader", add_shader, &ShaderKernel},
                    KernelCase{"Moving", add_moving, &MovingKernel},
                    KernelCase{"Foggy", add_fog, &FoggyKernel}, KernelCase{"All", add_all, &FullKernel}),
    [](const auto& kernel) { return std::string(kernel.param.name); });

TEST(Kernels, SupportTheirFeaturesAndAreOrderedBySize) {
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
        EXPECT_NE(kernel_for(1u << bit).features & (1u << bit), 0u) << bit;
    }
    for (std::size_t i = 0; i < Kernels.size(); ++i) {
        EXPECT_EQ(&kernel_for(Kernels[i]->features), Kernels[i]);
        for (std::size_t j = 0; j < i; ++j) EXPECT_NE(Kernels[i]->features & ~Kernels[j]->features, 0u);
    }
}

}  // namespace
}  // namespace tessera::embree
