#pragma once

#include <memory>
#include <vector>

#include "backends/vulkan/dispatch_budget.h"
#include "backends/vulkan/kernels.h"
#include "backends/vulkan/raster/raster_run.h"
#include "backends/vulkan/scene_adapter.h"
#include "backends/vulkan/tile_renderer.h"
#include "mediator/shading/raster.h"
#include "tests/backend/scene_builder.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

// A scene on a device under the validation layer, rasterised and traced by the back-end, and traced on the host by
// brute force.
class RasterTest : public VulkanTest {
  protected:
    RasterTest();
    void SetUp() override;
    void TearDown() override;

    // A mesh of its own object, white unless a material is named. Triangles of three indices each.
    ObjectId mesh(const std::vector<glm::vec3>& positions, const std::vector<std::uint32_t>& indices,
                  ObjectId material = {});
    ObjectId sphere(double radius, std::uint32_t rings, ObjectId material = {});
    ObjectId square(double half_edge, ObjectId material = {});  // in the xy plane
    ObjectId material(const scene::Material& values);
    void place(ObjectId mesh, const glm::dmat4& matrix);
    void light(const glm::dvec3& position, float intensity);
    void build(const glm::dvec3& render_origin = {});  // on the device; what was placed so far

    frame::FilmTile film(const view::View& view, const Rect& tile, frame::SampleBlock block,
                         const RasterSettings& settings = {});
    frame::FilmTile film(const view::View& view, frame::SampleBlock block,
                         const RasterSettings& settings = {}) {
        return film(view, view.window, block, settings);
    }
    // Instances drawn by the last step for one sample of the tile, after drawing `before` samples.
    std::uint32_t drawn(const view::View& view, const Rect& tile, const RasterSettings& settings,
                        std::uint32_t before);

    // The hit at the common subpixel position of a sample in each pixel of the picture.
    struct Seen {
        std::uint32_t object = 0;  // id
        float depth = shading::infinity();
    };
    std::vector<Seen> seen_by_rays(const view::View& view, std::uint64_t index) const;
    std::vector<Seen> seen_in(const frame::FilmTile& film, frame::ChannelSet channels) const;
    // The number of pixels whose ray hits differ, or whose depth differs by more than the tolerance.
    std::size_t differing(const view::View& view, std::uint64_t index, double tolerance = 1e-4);

    static view::View view_from(const glm::dvec3& eye, std::uint32_t width, std::uint32_t height);

    std::shared_ptr<scene::BlobStore> blobs_;
    std::unique_ptr<SceneAdapter> adapter_;

  private:
    ObjectId next() { return ObjectId{++last_id_}; }

    test::SceneBuilder builder_;
    std::vector<scene::Entry> entries_;
    scene::Root root_;
    std::uint64_t last_id_ = 100;
    std::unique_ptr<Kernels> kernels_;
    std::unique_ptr<RasterKernels> raster_kernels_;
    std::unique_ptr<RasterTargets> targets_;
    DispatchBudget dispatch_budget_;
};

}  // namespace tessera::vulkan
