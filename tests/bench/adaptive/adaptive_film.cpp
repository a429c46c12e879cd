#include "tests/bench/adaptive/adaptive_film.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <mutex>

#include "master/render/frame_assembler.h"
#include "mediator/base/clock.h"
#include "mediator/base/parallel.h"
#include "mediator/base/random.h"
#include "mediator/session/view_request.h"

namespace tessera::tools::bench {

namespace {

struct Unit {
    Rect tile;
    frame::SampleBlock block;
    std::string mask;
};

// Renders units on all threads. False: stopped.
class Units {
  public:
    Units(const Sampler& sampler, const view::View& view, tbb::task_arena& arena, const std::stop_token& stop)
        : sampler_(sampler), view_(view), arena_(arena), stop_(stop) {}

    template <class Take>
    bool render(const std::vector<Unit>& units, const Take& take) {
        const SteadyClock clock;
        const TimePoint started = clock.now();
        bool whole = true;
        std::mutex mutex;  // protects `whole`, and serializes take()
        parallel_for(arena_, units.size(), [&](std::size_t i) {
            const view::WorkUnit unit{.version = sampler_.backend().version(),
                                      .tile = units[i].tile,
                                      .block = units[i].block,
                                      .mask = units[i].mask};
            backend::RenderResult result = sampler_.backend().render(view_, unit, stop_);
            const std::scoped_lock lock(mutex);
            if (result.status != backend::RenderStatus::Done) {
                whole = false;
            } else {
                for (frame::FilmTile& block : result.blocks) take(std::move(block));
            }
        });
        seconds_ += tessera::seconds(clock.now() - started);
        return whole;
    }
    double seconds() const { return seconds_; }

  private:
    const Sampler& sampler_;
    const view::View& view_;
    tbb::task_arena& arena_;
    const std::stop_token& stop_;
    double seconds_ = 0.0;
};

std::vector<Unit> whole_tiles(const std::vector<Rect>& tiles, const frame::SampleBlock& block) {
    std::vector<Unit> units;
    for (const Rect& tile : tiles) units.push_back({tile, block, {}});
    return units;
}

}  // namespace

std::optional<AdaptiveFilm> adaptive_film(const Sampler& sampler, const view::View& view,
                                          const master::AdaptiveSettings& settings, const double* goal,
                                          tbb::task_arena& arena, const std::stop_token& stop) {
    const std::vector<Rect> tiles = master::tile_grid(view.window, sampler.tile());
    master::FrameAssembler film(tiles, view.channels, session::MaxSamplesPerPixel);
    AdaptiveFilm result{.whole = {}};
    Units units(sampler, view, arena, stop);
    const auto take = [&](frame::FilmTile&& block) {
        result.samples += block.block.count() * block.pixel_count();
        (void)film.insert(std::move(block), {});
    };
    constexpr frame::SampleBlock Base{
        0, static_cast<std::uint32_t>(std::countr_zero(session::StopRule::AdaptiveBase))};
    if (!units.render(whole_tiles(tiles, Base), take)) return std::nullopt;
    master::AdaptiveSettings next = settings;
    const SteadyClock clock;
    while (true) {
        const TimePoint started = clock.now();
        const std::vector<std::uint8_t> doublings = film.doublings();
        result.whole = film.whole();
        next.step = result.steps;
        const master::Step step =
            goal != nullptr ? master::next_step_to({view, *goal}, result.whole, doublings, tiles, next, arena)
                            : master::next_step(result.whole, doublings, tiles, next);
        result.seconds_deciding += seconds(clock.now() - started);
        result.noise = step.noise;
        result.error = step.error;
        if (step.rounds.empty()) break;
        ++result.steps;
        std::vector<Unit> dealt;
        for (const master::Round& round : step.rounds) {
            for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
                const master::RoundMask& mask = (*round.masks)[tile];
                if (mask.pixels > 0) dealt.push_back({tiles[tile], round.block, mask.bits});
            }
        }
        if (!units.render(dealt, take)) return std::nullopt;
    }
    result.seconds_sampling = units.seconds();
    return result;
}

std::optional<double> masked_rate(const Sampler& sampler, const view::View& view, tbb::task_arena& arena,
                                  const std::stop_token& stop) {
    constexpr frame::SampleBlock Block{16, 4};
    const std::vector<Rect> tiles = master::tile_grid(view.window, sampler.tile());
    const std::vector<Unit> all = whole_tiles(tiles, Block);
    std::vector<Unit> some;
    CounterRandom random(5);
    for (const Rect& tile : tiles) {
        std::vector<std::uint32_t> pixels;
        for (std::uint32_t i = 0; i < tile.pixel_count(); ++i) {
            if (random.below(4) == 0) pixels.push_back(i);
        }
        if (pixels.empty()) continue;
        some.push_back(
            {tile, Block, frame::PixelSet(std::move(pixels), tile.pixel_count()).bits(tile.pixel_count())});
    }
    // In turns, the fastest of each: the machine is not always ours.
    constexpr int Turns = 5;
    double best_all = 0.0, best_some = 0.0;
    for (int turn = 0; turn < Turns; ++turn) {
        for (const bool masked : {false, true}) {
            Units units(sampler, view, arena, stop);
            std::uint64_t samples = 0;
            const auto count = [&](const frame::FilmTile& block) {
                samples += block.block.count() * block.pixel_count();
            };
            if (!units.render(masked ? some : all, count)) return std::nullopt;
            double& best = masked ? best_some : best_all;
            best = std::max(best, double(samples) / units.seconds());
        }
    }
    return best_some / best_all;
}

}  // namespace tessera::tools::bench
