// The same samples give the same bits on any number of threads, and a stop is honoured.
#include <algorithm>
#include <cstring>
#include <random>
#include <thread>

#include "mediator/frame/block_forest.h"
#include "mediator/frame/resolve.h"
#include "tests/contract/filter_cases.h"
#include "tests/support/cpu_time.h"

namespace tessera::filter::test {
namespace {

class FilterBits : public FilterContract {};

TEST_P(FilterBits, DoNotDependOnTheNumberOfThreads) {
    const std::vector<Inputs> pictures{room_inputs(70, 45, 2), room_inputs(70, 45, 3)};
    std::vector<std::vector<float>> first;
    for (const int threads : {1, 2, 3}) {
        Subject subject(entry(), pictures[0], threads);
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            std::vector<float> numbers = subject.numbers(pictures[i], true);
            if (threads == 1) {
                first.push_back(std::move(numbers));
            } else {
                EXPECT_EQ(first_difference(first[i], numbers), "")
                    << name() << ": 1 and " << threads << " threads, picture " << i;
            }
        }
    }
}

TEST_P(FilterBits, AreTheSameAfterAReset) {
    const Inputs inputs = room_inputs(50, 40, 3), other = room_inputs(50, 40, 1);
    Subject subject(entry(), inputs);
    const std::vector<float> first = subject.numbers(inputs, true);
    if (!entry().description.temporal) {
        EXPECT_EQ(first_difference(first, subject.numbers(inputs, true)), "")
            << name() << " says that it is not temporal";
    }
    subject.numbers(other);
    subject.filter->reset();
    EXPECT_EQ(first_difference(first, subject.numbers(inputs, true)), "") << name();
}

TEST_P(FilterBits, DoNotDependOnWhatTheInstanceDidBeforeUnlessItIsTemporal) {
    if (entry().description.temporal) GTEST_SKIP();
    const Inputs inputs = room_inputs(50, 40, 3), other = room_inputs(50, 40, 16);
    Subject used(entry(), inputs), fresh(entry(), inputs);
    used.numbers(other);
    EXPECT_EQ(first_difference(fresh.numbers(inputs), used.numbers(inputs)), "") << name();
}

// --- from samples to the film

constexpr std::uint32_t Width = 45, Height = 33;
constexpr std::uint64_t Samples = 11;

frame::FilmTile samples_of(Rect rect, frame::SampleBlock block) {
    frame::FilmTile film =
        synthetic_film(static_cast<std::uint32_t>(rect.width), static_cast<std::uint32_t>(rect.height),
                       block.count(), EveryChannel, [&](auto x, auto y, auto i) {
                           // Even halves follow the index within the whole film: synthetic_film counts from 0
                           // and blocks of more than one sample begin at an even one.
                           return room(Width, Height, x + static_cast<std::uint32_t>(rect.x),
                                       y + static_cast<std::uint32_t>(rect.y), i + block.first);
                       });
    film.rect = rect;
    film.block = block;
    return film;
}

void paste(const frame::FilmTile& tile, frame::FilmTile& frame) {
    for (std::int32_t y = 0; y < tile.rect.height; ++y) {
        for (std::int32_t x = 0; x < tile.rect.width; ++x) {
            const auto from = static_cast<std::size_t>(y * tile.rect.width + x);
            const auto to = static_cast<std::size_t>((y + tile.rect.y) * frame.rect.width + x + tile.rect.x);
            frame.counts[to] = tile.counts[from];
            for (std::uint32_t p = 0; p < frame.channels.plane_count(); ++p) {
                std::memcpy(&frame.plane(p)[to], &tile.plane(p)[from], sizeof(float));
            }
        }
    }
}

// The whole frame from square tiles of `edge` pixels whose blocks arrive in a random order.
frame::FilmTile assembled(std::int32_t edge, std::uint32_t order) {
    frame::FilmTile film(Rect{0, 0, Width, Height}, {0, 0}, EveryChannel);
    std::mt19937 shuffle(order);
    for (std::int32_t top = 0; top < std::int32_t{Height}; top += edge) {
        for (std::int32_t left = 0; left < std::int32_t{Width}; left += edge) {
            const Rect rect{left, top, std::min(edge, std::int32_t{Width} - left),
                            std::min(edge, std::int32_t{Height} - top)};
            std::vector<frame::SampleBlock> blocks;
            // Pairs, since an odd sample alone would be the even one of its film.
            for (std::uint64_t i = 0; i + 1 < Samples; i += 2) blocks.push_back({i, 1});
            blocks.push_back({Samples - 1, 0});
            std::ranges::shuffle(blocks, shuffle);
            frame::BlockForest forest;
            for (const frame::SampleBlock& block : blocks) forest.insert(samples_of(rect, block));
            paste(forest.merged(), film);
        }
    }
    return film;
}

TEST_P(FilterBits, DoNotDependOnTilesAndTheirOrder) {
    const view::View view = synthetic_view(Width, Height);
    const frame::FilmTile whole = assembled(64, 1), tiled = assembled(16, 2), finer = assembled(7, 3);
    ASSERT_EQ(frame::film_hash(whole), frame::film_hash(tiled));
    const Inputs inputs = make_inputs(whole, view);
    Subject subject(entry(), inputs);
    const std::vector<float> expected = subject.numbers(inputs);
    for (const frame::FilmTile* film : {&tiled, &finer}) {
        const Inputs same = make_inputs(*film, view);
        Subject other(entry(), same);
        EXPECT_EQ(first_difference(expected, other.numbers(same)), "") << name();
    }
}

// --- stop

template <class Work>
double seconds_of(const Work& work) {
    const double from = tessera::test::thread_cpu_seconds();
    work();
    return tessera::test::thread_cpu_seconds() - from;
}

TEST_P(FilterBits, AStopBeforeTheRunCostsLittle) {
    const Inputs inputs = room_inputs(160, 120, 4);
    Subject subject(entry(), inputs, 1);
    const std::vector<float> expected = subject.numbers(inputs);
    subject.filter->reset();
    const double whole = seconds_of([&] { subject.picture(inputs); });
    std::stop_source stop;
    stop.request_stop();
    subject.filter->reset();
    Report report;
    const double stopped = seconds_of([&] {
        report = subject.filter->run(inputs, subject.values, subject.out, {subject.arena, stop.get_token()});
    });
    EXPECT_TRUE(report.stopped) << name();
    EXPECT_LE(stopped, 0.5 * whole + 2e-3) << name() << " goes on for " << stopped << " s of " << whole;
    subject.filter->reset();
    EXPECT_EQ(first_difference(expected, subject.numbers(inputs)), "") << name() << " after a stop";
}

TEST_P(FilterBits, AStopDuringTheRunIsReportedOrTooLate) {
    const Inputs inputs = room_inputs(160, 120, 4);
    Subject subject(entry(), inputs);
    const std::vector<float> expected = subject.numbers(inputs);
    const auto started = std::chrono::steady_clock::now();
    subject.filter->reset();
    subject.picture(inputs);
    const auto whole = std::chrono::steady_clock::now() - started;
    for (int tenth = 0; tenth < 10; ++tenth) {
        subject.filter->reset();
        std::stop_source stop;
        std::jthread later([&] {
            std::this_thread::sleep_for(whole * tenth / 10);
            stop.request_stop();
        });
        const Report report =
            subject.filter->run(inputs, subject.values, subject.out, {subject.arena, stop.get_token()});
        if (!report.stopped) {
            const std::vector<float> picture(subject.out.picture.values().begin(),
                                             subject.out.picture.values().end());
            EXPECT_EQ(first_difference(expected, picture), "")
                << name() << " was stopped, left something out and does not say so";
        }
        later.join();
    }
    subject.filter->reset();
    EXPECT_EQ(first_difference(expected, subject.numbers(inputs)), "") << name() << " after stops";
}

INSTANTIATE_TEST_SUITE_P(Catalog, FilterBits, testing::Range<std::size_t>(0, catalog().size()), filter_name);

}  // namespace
}  // namespace tessera::filter::test
