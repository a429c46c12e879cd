// Light samples of the sky where it is seen (mediator/shading/sky_cells.h), of every back-end that traces light.
#include <cmath>
#include <functional>

#include "mediator/scene/scene.h"
#include "tests/contract/backend_contract.h"
#include "tests/statistics/room.h"

namespace tessera::backend {
namespace {

using frame::FilmTile;

struct BackendSkyCells : testing::TestWithParam<std::string> {
    BackendSkyCells() : BackendSkyCells([](test::SceneModel& lit) { test::add_sky_with_sun(lit, 100.0f); }) {}
    explicit BackendSkyCells(const std::function<void(test::SceneModel&)>& add_lights) {
        test::add_room(room);
        add_lights(room);
        content = scene::snapshot(room.finished());
        backend = fresh(2);
        view.id = ViewId{1};
        view.channels = {frame::Channel::Radiance};
        view.sky_cells_from = 0;
    }

    std::unique_ptr<Backend> fresh(std::uint32_t threads) const {
        auto made = find_backend(GetParam()).make({.threads = threads, .isa = {}, .blobs = room.blobs()});
        test::commit(*made, {content});
        return made;
    }
    static view::WorkUnit unit(const Backend& with, const view::View& of, const Rect& tile,
                               frame::SampleBlock block) {
        return {.id = UnitId{1},
                .view = of.id,
                .revision = of.revision,
                .version = with.version(),
                .tile = tile,
                .block = block};
    }
    static FilmTile render(Backend& with, const view::View& of, const Rect& tile, frame::SampleBlock block) {
        RenderResult result = with.render(of, unit(with, of, tile, block), {});
        EXPECT_EQ(result.status, RenderStatus::Done);
        return std::move(result.blocks.at(0));
    }
    // Of the mean of all pixels, in `Blocks` blocks of independent samples.
    struct Mean {
        double value = 0.0, standard_error = 0.0;
    };
    static constexpr int Blocks = 16;
    Mean mean_of(const view::View& of) const {
        double sum = 0.0, squares = 0.0;
        for (std::uint64_t block = 0; block < Blocks; ++block) {
            view::View other = of;
            other.seed = of.seed + block;
            const FilmTile film = render(*backend, other, whole, {0, 3});
            double mean = 0.0;
            for (const float value : film.plane(0)) mean += double(value) / double(whole.pixel_count());
            sum += mean;
            squares += mean * mean;
        }
        const double mean = sum / Blocks;
        return {mean, std::sqrt(std::max(squares / Blocks - mean * mean, 0.0) / (Blocks - 1))};
    }

    void expect_same_light_and_less_noise() const {
        view::View without = view;
        without.sky_cells_from = view::NoSkyCells;
        const Mean plain = mean_of(without), guided = mean_of(view);
        EXPECT_GT(plain.value, 0.0);
        EXPECT_NEAR(guided.value, plain.value, 4.0 * std::hypot(plain.standard_error, guided.standard_error));
        EXPECT_LT(guided.standard_error, 0.9 * plain.standard_error);
    }

    test::SceneModel room;
    scene::ChangeList content;
    std::unique_ptr<Backend> backend;
    view::View view = test::inside_room();
    Rect whole{0, 0, 16, 16};
};

TEST_P(BackendSkyCells, KeepTheLightAndHaveLessNoise) {
    expect_same_light_and_less_noise();
}

// A lamp, and a sun on the wall outside; no sky.
struct BackendSunCells : BackendSkyCells {
    BackendSunCells()
        : BackendSkyCells([](test::SceneModel& lit) {
              lit.point_light({0.0, 0.0, 1.5}, 1.0f);
              lit.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(20.0f)},
                        glm::rotate(glm::dmat4(1.0), -1.2, {0.0, 1.0, 0.0}));
          }) {}
};

TEST_P(BackendSunCells, KeepTheLightAndHaveLessNoise) {
    expect_same_light_and_less_noise();
}

// Whatever part of the picture a node renders first, and when and with how many threads it makes the cells.
TEST_P(BackendSkyCells, ASampleDoesNotDependOnItsUnit) {
    const FilmTile all = render(*backend, view, whole, {4, 1});
    const auto other = fresh(1);
    const Rect part{5, 3, 7, 9};
    for (int turn = 0; turn < 2; ++turn) {
        const FilmTile some = render(*other, view, part, {4, 1});
        for (std::int32_t y = 0; y < part.height; ++y) {
            for (std::int32_t x = 0; x < part.width; ++x) {
                const auto at = static_cast<std::size_t>(y * part.width + x);
                const auto in_all = static_cast<std::size_t>((part.y + y) * whole.width + part.x + x);
                for (std::uint32_t c = 0; c < 3; ++c) ASSERT_EQ(some.plane(c)[at], all.plane(c)[in_all]);
            }
        }
    }
}

TEST_P(BackendSkyCells, AStoppedUnitIsStopped) {
    std::stop_source source;
    source.request_stop();
    const RenderResult result =
        backend->render(view, unit(*backend, view, whole, {0, 0}), source.get_token());
    EXPECT_EQ(result.status, RenderStatus::Stopped);
    EXPECT_GT(render(*backend, view, whole, {0, 3}).plane(0).size(), 0u);
}

std::vector<std::string> that_trace() {
    std::vector<std::string> names = BackendContract::names();
    std::erase(names, "null");
    return names;
}

INSTANTIATE_TEST_SUITE_P(Catalog, BackendSkyCells, testing::ValuesIn(that_trace()),
                         [](const auto& entry) { return entry.param; });
INSTANTIATE_TEST_SUITE_P(Catalog, BackendSunCells, testing::ValuesIn(that_trace()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace tessera::backend
