#include "tests/vulkan/raster_fixture.h"

#include <bit>
#include <cmath>
#include <numbers>

#include "backends/vulkan/device/transfer.h"
#include "mediator/backend/tables/view_record.h"
#include "mediator/shading/materials.h"

namespace tessera::vulkan {

namespace {

template <class T>
scene::BlobRef blob_of(scene::BlobStore& store, const std::vector<T>& values) {
    return scene::reference(*store.insert(std::as_bytes(std::span(values))));
}

}  // namespace

RasterTest::RasterTest() : blobs_(std::make_shared<scene::BlobStore>()) {}

void RasterTest::SetUp() {
    VulkanTest::SetUp();
    ASSERT_TRUE(device().info().draws) << "the device has no graphics";
    kernels_ = std::make_unique<Kernels>(device());
    raster_kernels_ = std::make_unique<RasterKernels>(device());
    targets_ = std::make_unique<RasterTargets>(device());
    adapter_ = std::make_unique<SceneAdapter>(blobs_, std::filesystem::path{});
    adapter_->move_to(&device());
}

void RasterTest::TearDown() {
    adapter_.reset();
    targets_.reset();
    raster_kernels_.reset();
    kernels_.reset();
    VulkanTest::TearDown();
}

ObjectId RasterTest::mesh(const std::vector<glm::vec3>& positions, const std::vector<std::uint32_t>& indices,
                          ObjectId material) {
    scene::Geometry geometry;
    geometry.material = material;
    geometry.positions = blob_of(*blobs_, positions);
    geometry.indices = blob_of(*blobs_, indices);
    const ObjectId id = next();
    entries_.push_back(scene::Create{id, geometry});
    return id;
}

ObjectId RasterTest::sphere(double radius, std::uint32_t rings, ObjectId material) {
    const std::uint32_t sides = 2 * rings;
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i <= rings; ++i) {
        for (std::uint32_t j = 0; j < sides; ++j) {
            const double polar = std::numbers::pi * i / rings, around = 2 * std::numbers::pi * j / sides;
            positions.emplace_back(radius * glm::dvec3(std::sin(polar) * std::cos(around), std::cos(polar),
                                                       std::sin(polar) * std::sin(around)));
        }
    }
    for (std::uint32_t i = 0; i < rings; ++i) {
        for (std::uint32_t j = 0; j < sides; ++j) {
            const std::uint32_t a = i * sides + j, b = i * sides + (j + 1) % sides;
            indices.insert(indices.end(), {a, b, a + sides, b, b + sides, a + sides});
        }
    }
    return mesh(positions, indices, material);
}

ObjectId RasterTest::square(double half_edge, ObjectId material) {
    const auto h = static_cast<float>(half_edge);
    return mesh({{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}}, {0, 1, 2, 0, 2, 3}, material);
}

ObjectId RasterTest::material(const scene::Material& values) {
    const ObjectId id = next();
    entries_.push_back(scene::Create{id, values});
    return id;
}

void RasterTest::place(ObjectId mesh, const glm::dmat4& matrix) {
    const ObjectId id = next();
    entries_.push_back(scene::Create{id, test::transform(matrix, {mesh})});
    root_.children.push_back(id);
}

void RasterTest::light(const glm::dvec3& position, float intensity) {
    scene::Light lamp;
    lamp.intensity = glm::vec3(intensity);
    const ObjectId id = next();
    entries_.push_back(scene::Create{id, lamp});
    place(id, test::moved(position.x, position.y, position.z));
}

void RasterTest::build(const glm::dvec3& render_origin) {
    root_.render_origin = render_origin;
    std::vector<scene::Entry> entries{scene::Create{scene::RootId, root_}};
    entries.insert(entries.end(), entries_.begin(), entries_.end());
    const auto applied = adapter_->apply(builder_.edit(std::move(entries)));
    ASSERT_TRUE(applied) << applied.error().what();
    const auto done = adapter_->commit();
    ASSERT_TRUE(done) << done.error().what();
}

view::View RasterTest::view_from(const glm::dvec3& eye, std::uint32_t width, std::uint32_t height) {
    view::View view;
    view.id = ViewId{1};
    view.width = width;
    view.height = height;
    view.window = {0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    view.camera = view::perspective(test::moved(eye.x, eye.y, eye.z), 1.0, double(width) / double(height));
    view.seed = 7;
    view.channels = {frame::Channel::Radiance, frame::Channel::Depth, frame::Channel::ObjectIndex};
    view.renderer = view::Renderer::Raster;
    return view;
}

frame::FilmTile RasterTest::film(const view::View& view, const Rect& tile, frame::SampleBlock block,
                                 const RasterSettings& settings) {
    const RasterTools tools{*raster_kernels_, *targets_, settings};
    const bool rasters = view.renderer == view::Renderer::Raster;
    const shading::View record = backend::make_view(view, adapter_->tables().render_origin);
    const TileRenderer renderer{device(),
                                *kernels_,
                                dispatch_budget_,
                                adapter_->scene(),
                                backend::features_for(adapter_->tables(), record),
                                rasters ? &tools : nullptr};
    const view::WorkUnit unit{.view = view.id,
                              .revision = view.revision,
                              .version = adapter_->version(),
                              .tile = tile,
                              .block = block};
    backend::RenderResult result = renderer.run(record, unit, view.channels, {});
    EXPECT_EQ(result.status, backend::RenderStatus::Done);
    return std::move(result.blocks.at(0));
}

std::uint32_t RasterTest::drawn(const view::View& view, const Rect& tile, const RasterSettings& settings,
                                std::uint32_t before) {
    const shading::View record = backend::make_view(view, adapter_->tables().render_origin);
    const Buffer view_buffer = make_buffer(device(), std::vector<shading::View>{record});
    const GpuScene& scene = adapter_->scene();
    const RasterKernels::Set kernels = raster_kernels_->find(scene.features());
    RasterTarget target(device(), view.width, view.height, scene.instance_count());
    const RasterPass pass{device(), kernels, scene, target, settings, record, view_buffer.address()};
    const Buffer seen(device(), tile.pixel_count() * 8);
    std::vector<Step> steps;
    for (std::uint32_t i = 0; i <= before; ++i) pass.add_steps(steps, tile, 0, seen, 0);
    device().queue().submit(steps);
    std::uint32_t count = 0;
    for (const auto& draw : download<VkDrawIndirectCommand>(device(), target.draws)) {
        count += draw.instanceCount;
    }
    return count;
}

std::vector<RasterTest::Seen> RasterTest::seen_by_rays(const view::View& view, std::uint64_t index) const {
    const backend::SceneTables& tables = adapter_->tables();
    const shading::Scene scene = backend::on_host(tables);
    const shading::View record = backend::make_view(view, tables.render_origin);
    std::vector<Seen> result;
    for (std::uint32_t y = 0; y < view.height; ++y) {
        for (std::uint32_t x = 0; x < view.width; ++x) {
            const shading::Ray ray = shading::camera_ray(record, x, y, shading::raster_place(record, index));
            const shading::BvhRay from_eye = shading::bvh_ray(glm::vec3(0.0f), ray.direction);
            const shading::Sampler numbers = shading::path_ray_numbers(
                shading::start_path(shading::make_sampler(x, y, record.seed, index)));
            Seen seen;
            float nearest = shading::infinity();
            for (std::uint32_t i = 0; i < scene.instance_count; ++i) {
                const shading::Instance& instance = scene.instances.items[i];
                const shading::Mesh& mesh = scene.meshes.items[instance.mesh];
                for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
                    const shading::Triangle corners = shading::triangle_in(mesh, t);
                    const shading::BvhCrossing crossing = shading::bvh_cross_triangle(
                        from_eye, shading::seen_from(ray.origin, instance, corners.p),
                        shading::seen_from(ray.origin, instance, corners.q),
                        shading::seen_from(ray.origin, instance, corners.r));
                    if (!crossing.crosses || !(crossing.distance > 0.0f && crossing.distance < nearest))
                        continue;
                    const bool stops =
                        instance.alpha_tested == 0 || shading::stops_at(scene, shading::skip_nothing(), i, t,
                                                                        crossing.barycentric, numbers);
                    if (!stops) continue;
                    nearest = crossing.distance;
                    seen = {instance.object, shading::depth_along(record, ray, nearest)};
                }
            }
            result.push_back(seen);
        }
    }
    return result;
}

std::vector<RasterTest::Seen> RasterTest::seen_in(const frame::FilmTile& film,
                                                  frame::ChannelSet channels) const {
    const auto depths = film.plane(channels.first_plane(frame::Channel::Depth));
    const auto objects = film.plane(channels.first_plane(frame::Channel::ObjectIndex) + 1);
    std::vector<Seen> result;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        result.push_back({std::bit_cast<std::uint32_t>(objects[i]), depths[i]});
    }
    return result;
}

std::size_t RasterTest::differing(const view::View& view, std::uint64_t index, double tolerance) {
    const std::vector<Seen> expected = seen_by_rays(view, index);
    const std::vector<Seen> found = seen_in(film(view, {index, 0}), view.channels);
    std::size_t count = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const Seen &a = expected[i], &b = found[i];
        const bool same_depth =
            a.depth == b.depth || std::fabs(double(a.depth) - double(b.depth)) <= tolerance * double(a.depth);
        count += a.object == b.object && same_depth ? 0 : 1;
    }
    return count;
}

}  // namespace tessera::vulkan
