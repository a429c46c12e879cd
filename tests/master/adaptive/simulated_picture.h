#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "master/render/adaptive/step.h"
#include "master/render/frame_assembler.h"
#include "mediator/base/random.h"
#include "mediator/frame/block_stack.h"
#include "mediator/frame/merge.h"

namespace tessera::master {

// A picture whose samples are independent, of mean 1 and a deviation that depends on the pixel; rendered as a cluster
// would, without one.
class SimulatedPicture {
  public:
    using Sample = std::function<float(std::int32_t x, std::int32_t y, CounterRandom& random)>;
    static constexpr frame::ChannelSet Channels{frame::Channel::Radiance, frame::Channel::BlockVariance};

    SimulatedPicture(std::int32_t width, std::int32_t height, std::uint32_t tile, Sample sample,
                     std::uint64_t seed = 1, std::uint32_t base_level = 4)
        : tiles_(tile_grid({0, 0, width, height}, tile)),
          film_(tiles_, Channels, std::uint64_t{1} << 31),
          sample_(std::move(sample)),
          seed_(seed) {
        for (const Rect& rect : tiles_) render(rect, {0, base_level}, {});
    }

    const std::vector<Rect>& tiles() const { return tiles_; }
    frame::FilmTile film() const { return film_.whole(); }
    std::vector<std::uint8_t> doublings() const { return film_.doublings(); }
    std::uint64_t samples() const { return samples_; }

    Step next(const AdaptiveSettings& settings, tbb::task_arena* arena = nullptr) const {
        const std::vector<std::uint8_t> known = doublings();
        return next_step(film(), known, tiles_, settings, arena);
    }
    void render(const std::vector<Round>& rounds) {
        for (const Round& round : rounds) {
            for (std::size_t i = 0; i < tiles_.size(); ++i) {
                const RoundMask& mask = (*round.masks)[i];
                if (mask.pixels == 0) continue;
                const auto pixels = frame::PixelSet::from_bits(mask.bits, tiles_[i].pixel_count());
                render(tiles_[i], round.block, *pixels);
            }
        }
    }
    // Until no step follows; the last one.
    Step finish(AdaptiveSettings settings) {
        for (settings.step = 0; settings.step < 100; ++settings.step) {
            Step step = next(settings);
            if (step.rounds.empty()) return step;
            render(step.rounds);
        }
        return {};
    }
    // sqrt(relMSE) against the mean of 1.
    double true_noise() const {
        const frame::FilmTile all = film();
        double sum = 0.0;
        for (const float value : all.plane(0)) sum += (value - 1.0) * (value - 1.0) / 1.01;
        return std::sqrt(sum / static_cast<double>(all.pixel_count()));
    }

  private:
    void render(const Rect& rect, const frame::SampleBlock& block, const frame::PixelSet& pixels) {
        frame::BlockStack stack;
        for (std::uint64_t index = block.first; index < block.end(); ++index) {
            frame::FilmTile tile = stack.recycled(rect, {index, 0}, Channels, pixels);
            for (std::size_t i = 0; i < tile.pixel_count(); ++i) {
                const auto at = static_cast<std::int32_t>(pixels.index(i));
                const std::int32_t x = rect.x + at % rect.width, y = rect.y + at / rect.width;
                CounterRandom random(seed_ + 7919 * static_cast<std::uint64_t>(y * 65536 + x), index);
                const float value = sample_(x, y, random);
                frame::put_sample(tile, i, std::array{value, value, value});
            }
            stack.push(std::move(tile));
        }
        for (frame::FilmTile& done : stack.take()) {
            samples_ += done.block.count() * done.pixel_count();
            film_.insert(std::move(done), {});
        }
    }

    std::vector<Rect> tiles_;
    FrameAssembler film_;
    Sample sample_;
    std::uint64_t seed_, samples_ = 0;
};

}  // namespace tessera::master
