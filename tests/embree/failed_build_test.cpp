// A build that Embree cannot finish leaves the last version as it was.
#include <gtest/gtest.h>

#include <cstring>

#include "backends/embree/path_tracer.h"
#include "backends/embree/scene_adapter.h"
#include "tests/backend/scene_builder.h"
#include "tests/statistics/scene_model.h"

namespace tessera::embree {
namespace {

using scene::Geometry;

constexpr ObjectId SheetId{2}, DaylightId{3};

// Refuses memory once, at a chosen allocation after it was armed.
struct Memory {
    int until_refusal = -1;  // allocations; < 0: none is refused
    static bool allowed(void* self, ssize_t bytes, bool) {
        auto& memory = *static_cast<Memory*>(self);
        if (bytes <= 0 || memory.until_refusal < 0) return true;
        return memory.until_refusal-- != 0;
    }
};

struct FailedBuild : testing::Test {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    DeviceHandle device = make_device({.threads = 1, .blobs = blobs});
    Memory memory;
    test::SceneBuilder builder;

    FailedBuild() { rtcSetDeviceMemoryMonitorFunction(device.get(), &Memory::allowed, &memory); }

    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        return scene::reference(*blobs->insert(std::as_bytes(std::span(values))));
    }
    Geometry sheet(float height) {
        std::vector<glm::vec3> positions;
        std::vector<std::uint32_t> indices;
        constexpr std::uint32_t Side = 24;
        for (std::uint32_t y = 0; y <= Side; ++y) {
            for (std::uint32_t x = 0; x <= Side; ++x) {
                positions.emplace_back(2.0f * float(x) / Side - 1, 2.0f * float(y) / Side - 1,
                                       height * float((x * 7 + y * 3) % 5));
                const std::uint32_t a = y * (Side + 1) + x, b = a + Side + 1;
                if (x < Side && y < Side) indices.insert(indices.end(), {a, a + 1, b, a + 1, b + 1, b});
            }
        }
        return {.indices = blob(indices), .positions = blob(positions)};
    }
    std::vector<PathSample> picture(const SceneAdapter& adapter) const {
        const view::View view = test::small_view({0, 0, 2}, 1.0, 24);
        const PathTracer tracer(adapter.tables(), adapter.scene(), view);
        std::vector<PathSample> samples;
        std::uint64_t rays = 0;
        for (std::uint32_t i = 0; i < 24 * 24; ++i) samples.push_back(tracer.trace(i % 24, i / 24, 0, rays));
        return samples;
    }
};

bool same_kept_bits(const std::vector<PathSample>& a, const std::vector<PathSample>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(PathSample)) == 0;
}

TEST_F(FailedBuild, KeepsTheLastVersionWhereverTheMemoryEnds) {
    SceneAdapter adapter(device.get(), blobs);
    ASSERT_TRUE(adapter.apply(builder.edit(
        {scene::Create{SheetId, sheet(0.0f)}, scene::Create{DaylightId, scene::Background{}},
         scene::Create{scene::RootId, scene::Root{.children = {SheetId}, .background = DaylightId}}})));
    ASSERT_TRUE(adapter.commit());
    const Version version = adapter.version();
    const std::vector<PathSample> before = picture(adapter);

    const scene::ChangeList change =
        builder.edit({test::SceneBuilder::update<Geometry>(SheetId, &Geometry::positions, sheet(0.1f))});
    int failures = 0;
    for (int allocation = 0; allocation < 64; ++allocation) {
        ASSERT_TRUE(adapter.apply(change));
        memory.until_refusal = allocation;
        const auto report = adapter.commit();
        memory.until_refusal = -1;
        if (report) break;  // it needs fewer allocations
        ++failures;
        EXPECT_EQ(int(report.error().code()), int(ErrorCode::OutOfMemory)) << report.error().what();
        EXPECT_EQ(adapter.version(), version);
        EXPECT_TRUE(same_kept_bits(picture(adapter), before)) << "after allocation " << allocation;
    }
    EXPECT_GT(failures, 2);
    EXPECT_NE(adapter.version(), version) << "the change is fine with enough memory";
    EXPECT_FALSE(same_kept_bits(picture(adapter), before));
}

}  // namespace
}  // namespace tessera::embree
