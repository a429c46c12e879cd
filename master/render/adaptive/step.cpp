#include "master/render/adaptive/step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mediator/frame/pixel_set.h"
#include "mediator/picture/noise_map.h"

namespace tessera::master {

namespace {

constexpr double UniformShare = 0.125;
constexpr double Unlimited = std::numeric_limits<double>::max();

std::uint32_t reversed(std::uint32_t x) {
    std::uint32_t result = 0;
    for (int bit = 0; bit < 32; ++bit) result |= (x >> bit & 1u) << (31 - bit);
    return result;
}
std::uint32_t spread(std::uint32_t x) {
    x &= 0xffffu;
    x = (x | x << 8) & 0x00ff00ffu;
    x = (x | x << 4) & 0x0f0f0f0fu;
    x = (x | x << 2) & 0x33333333u;
    return (x | x << 1) & 0x55555555u;
}

// In [0, 1). The pixels whose rank lies in an interval are evenly spread over the picture: neighbours along a Morton curve
// have distant ranks.
double rank(std::size_t x, std::size_t y, std::uint32_t step) {
    constexpr double GoldenRatio = 0.6180339887498949;
    const std::uint32_t along = spread(static_cast<std::uint32_t>(x)) | spread(static_cast<std::uint32_t>(y))
                                                                            << 1;
    const double base = reversed(along) * 0x1p-32 + GoldenRatio * step;
    return base - std::floor(base);
}

struct Candidate {
    float gain;  // of relMSE per sample
    std::uint32_t pixel;
};

class Chooser {
  public:
    Chooser(const frame::FilmTile& film, std::span<const std::uint8_t> doublings,
            const AdaptiveSettings& settings, tbb::task_arena* arena, std::span<const float> deviations)
        : film_(film),
          doublings_(doublings),
          settings_(settings),
          noise_(film, arena),
          deviations_(deviations.empty() ? noise_.deviations() : deviations),
          is_chosen_(film.pixel_count(), false) {}

    double noise() const { return noise_.noise(); }
    const std::vector<bool>& choose() {
        if (settings_.uniform) {
            choose_all();
        } else {
            choose_by_noise();
            add_uniform();
        }
        return is_chosen_;
    }

    // Of all pixels.
    std::uint64_t samples() const {
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < is_chosen_.size(); ++i) sum += samples(i);
        return sum;
    }
    // The same when they have what they need.
    std::uint64_t samples_expected() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < is_chosen_.size(); ++i) {
            const double n = double(samples(i)), most = double(settings_.max_samples);
            sum += may_have_more(i) ? std::max(n, std::min(best(i), most)) : n;
        }
        return static_cast<std::uint64_t>(sum);
    }

  private:
    double best(std::size_t pixel) const { return deviations_[pixel] * best_per_deviation_; }
    double square(std::size_t pixel) const {
        const double deviation = deviations_[pixel];
        return deviation * deviation;
    }
    bool may_have_more(std::size_t pixel) const {
        return doublings_[pixel] != 255 && film_.counts[pixel] > 0 &&
               2 * samples(pixel) <= settings_.max_samples;
    }
    std::uint64_t samples(std::size_t pixel) const {
        return doublings_[pixel] == 255 ? film_.counts[pixel] : std::uint64_t{1} << doublings_[pixel];
    }

    void choose_all() {
        for (std::size_t i = 0; i < is_chosen_.size(); ++i) is_chosen_[i] = may_have_more(i);
    }

    void choose_by_noise() {
        double sum = 0.0, error = 0.0;
        for (std::size_t i = 0; i < deviations_.size(); ++i) {
            if (film_.counts[i] == 0) continue;
            sum += deviations_[i];
            error += square(i) / double(samples(i));
        }
        // Averaged deviations say less than relMSE: the same part of both is wanted.
        const double wanted = settings_.noise / noise();
        const double target = error * (settings_.part > 0.0 ? settings_.part : wanted * wanted);
        const double allowed = settings_.samples > 0 ? double(settings_.samples) : Unlimited;
        if (!(sum > 0.0)) return;
        best_per_deviation_ = std::min(sum / target, affordable(allowed));
        const double left = (allowed - double(samples())) * (1.0 - UniformShare);
        std::vector<Candidate> candidates = candidates_if(
            [&](std::size_t pixel) { return double(samples(pixel)) * std::sqrt(2.0) <= best(pixel); });
        // All are within rounding of what they need.
        if (candidates.empty())
            candidates = candidates_if([&](std::size_t pixel) { return deviations_[pixel] > 0.0f; });
        double reduction = 0.0;
        for (const Candidate& candidate : candidates)
            reduction += 0.5 * candidate.gain * double(samples(candidate.pixel));
        if (error - reduction <= target || allowed < Unlimited) sort(candidates);  // else all are doubled
        for (const Candidate& candidate : candidates) {
            if (error <= target || dealt_ + double(samples(candidate.pixel)) > left) return;
            is_chosen_[candidate.pixel] = true;
            dealt_ += double(samples(candidate.pixel));
            error -= 0.5 * square(candidate.pixel) / double(samples(candidate.pixel));
        }
    }

    // Samples per deviation with which all pixels together have as many as they may, if none gives back those that it has.
    double affordable(double allowed) const {
        double part = Unlimited;
        for (double last = 0.0; part != last;) {  // it decreases, as pixels leave the sums
            last = part;
            double left = allowed, sum = 0.0;
            for (std::size_t i = 0; i < deviations_.size(); ++i) {
                const double n = double(samples(i)), deviation = deviations_[i];
                const bool gets_more = may_have_more(i) && n < part * deviation;
                gets_more ? sum += deviation : left -= n;
            }
            part = sum > 0.0 ? std::min(part, std::max(left, 0.0) / sum) : 0.0;
        }
        return part;
    }

    // Of the pixels that may have more.
    template <class Wanted>
    std::vector<Candidate> candidates_if(const Wanted& is_wanted) const {
        std::vector<Candidate> candidates;
        for (std::uint32_t i = 0; i < is_chosen_.size(); ++i) {
            const double n = double(samples(i));
            if (may_have_more(i) && is_wanted(i))
                candidates.push_back({static_cast<float>(square(i) / (n * n)), i});
        }
        return candidates;
    }

    // Pixels that gain most first.
    static void sort(std::vector<Candidate>& candidates) {
        std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
            return a.gain != b.gain ? a.gain > b.gain : a.pixel < b.pixel;
        });
    }

    void add_uniform() {
        double others = 0.0;
        for (std::size_t i = 0; i < is_chosen_.size(); ++i) {
            if (!is_chosen_[i] && may_have_more(i)) others += double(samples(i));
        }
        if (others == 0.0 || dealt_ == 0.0) return;
        const double share = std::min(1.0, dealt_ * UniformShare / (1.0 - UniformShare) / others);
        const auto width = static_cast<std::size_t>(film_.rect.width);
        for (std::size_t i = 0; i < is_chosen_.size(); ++i) {
            if (!is_chosen_[i] && may_have_more(i) && rank(i % width, i / width, settings_.step) < share)
                is_chosen_[i] = true;
        }
    }

    const frame::FilmTile& film_;
    std::span<const std::uint8_t> doublings_;
    const AdaptiveSettings& settings_;
    picture::NoiseMap noise_;
    std::span<const float> deviations_;  // of this step
    std::vector<bool> is_chosen_;
    double dealt_ = 0.0, best_per_deviation_ = 0.0;
};

}  // namespace

AdaptiveSettings settings_of_mean(std::uint64_t mean, std::size_t pixels, std::uint32_t step, bool uniform) {
    constexpr std::uint64_t MostOfAPixel = 64;
    if (uniform) return {.max_samples = mean, .step = step, .uniform = true};
    return {.samples = mean * pixels,
            .max_samples = std::min(session::MaxSamplesPerPixel, MostOfAPixel * mean),
            .step = step};
}

Step next_step(const frame::FilmTile& film, std::span<const std::uint8_t> doublings,
               std::span<const Rect> tiles, const AdaptiveSettings& settings, tbb::task_arena* arena,
               std::span<const float> deviations) {
    Chooser chooser(film, doublings, settings, arena, deviations);
    Step step{.noise = chooser.noise(), .rounds = {}};
    if (settings.part >= 1.0 || (settings.noise > 0.0 && step.noise <= settings.noise)) {
        step.samples_expected = chooser.samples();
        return step;
    }
    const std::vector<bool>& is_chosen = chooser.choose();
    step.samples_expected = chooser.samples_expected();
    PixelsByRound pixels;
    const auto width = static_cast<std::size_t>(film.rect.width);
    for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
        const Rect& rect = tiles[tile];
        std::uint32_t index = 0;
        for (std::int32_t y = rect.y; y < rect.bottom(); ++y) {
            for (std::int32_t x = rect.x; x < rect.right(); ++x, ++index) {
                const std::size_t at = static_cast<std::size_t>(y - film.rect.y) * width +
                                       static_cast<std::size_t>(x - film.rect.x);
                if (is_chosen[at]) pixels[{doublings[at], tile}].push_back(index);
            }
        }
    }
    step.rounds = rounds_of(std::move(pixels), tiles);
    return step;
}

std::vector<Round> rounds_of(PixelsByRound&& pixels, std::span<const Rect> tiles) {
    std::vector<Round> rounds;
    std::vector<RoundMask> masks(tiles.size());
    for (auto entry = pixels.begin(); entry != pixels.end();) {
        const auto [level, tile] = entry->first;
        const std::size_t all = tiles[tile].pixel_count();
        const frame::PixelSet set(std::move(entry->second), all);
        masks[tile] = {set.bits(all), static_cast<std::uint32_t>(set.count(all))};
        if (++entry != pixels.end() && entry->first.first == level) continue;
        rounds.push_back({{std::uint64_t{1} << level, level},
                          std::make_shared<const std::vector<RoundMask>>(std::move(masks))});
        masks.assign(tiles.size(), {});
    }
    return rounds;
}

}  // namespace tessera::master
