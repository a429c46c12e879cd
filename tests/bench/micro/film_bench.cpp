// The path of film data: a sample into a tile, merging tiles, tiles on the wire. Each is compared with the
// memory bandwidth that bounds it.
#include <benchmark/benchmark.h>

#include <cstring>

#include "mediator/base/random.h"
#include "mediator/frame/block_forest.h"
#include "mediator/frame/block_stack.h"
#include "mediator/frame/merge.h"
#include "mediator/wire/envelope.h"

namespace {

using namespace tessera;
using namespace tessera::frame;

constexpr ChannelSet AllChannels{Channel::Radiance,   Channel::LowVariance, Channel::HighVariance,
                                 Channel::Albedo,     Channel::Normal,      Channel::Depth,
                                 Channel::ObjectIndex};
constexpr ChannelSet WithErrors = AllChannels | ChannelSet{Channel::BlockVariance};
constexpr ChannelSet WithHalves = WithErrors | ChannelSet{Channel::FirstHalf};
constexpr Rect Tile{0, 0, 64, 64};

FilmTile filled(SampleBlock block, std::uint64_t seed, const ChannelSet& channels = AllChannels) {
    FilmTile tile(Tile, block, channels);
    CounterRandom random(seed);
    std::vector<float> sample(17);
    for (std::size_t pixel = 0; pixel < tile.pixel_count(); ++pixel) {
        for (float& value : sample) value = static_cast<float>(random.uniform());
        put_sample(tile, pixel, sample);
    }
    return tile;
}

void set_bytes(benchmark::State& state, std::size_t per_iteration) {
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * per_iteration));
}

// The upper bound of all of the following: a merge reads two tiles and writes one.
void memory_copy(benchmark::State& state) {
    const FilmTile source = filled({0, 0}, 1);
    FilmTile target = source;
    for (auto _ : state) {
        std::memcpy(target.planes.data(), source.planes.data(), source.planes.size() * sizeof(float));
        benchmark::DoNotOptimize(target.planes.data());
        benchmark::ClobberMemory();
    }
    set_bytes(state, 2 * source.byte_size());
}
BENCHMARK(memory_copy);

void merge_siblings(benchmark::State& state, const ChannelSet& channels) {
    const FilmTile a = filled({0, 0}, 1, channels), b = filled({1, 0}, 2, channels);
    FilmTile into = a;
    for (auto _ : state) {
        into = a;
        merge(into, b);
        benchmark::DoNotOptimize(into.planes.data());
    }
    set_bytes(state, 5 * a.byte_size());  // the copy reads and writes one, the merge reads two and writes one
}
BENCHMARK_CAPTURE(merge_siblings, plain, AllChannels);
BENCHMARK_CAPTURE(merge_siblings, and_block_variance, WithErrors);
BENCHMARK_CAPTURE(merge_siblings, and_first_half, WithHalves);

void put_samples(benchmark::State& state) {
    FilmTile tile(Tile, {0, 0}, AllChannels);
    const std::vector<float> sample(17, 0.5f);
    for (auto _ : state) {
        tile = FilmTile(Tile, {0, 0}, AllChannels);
        for (std::size_t pixel = 0; pixel < tile.pixel_count(); ++pixel) put_sample(tile, pixel, sample);
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * tile.pixel_count()));
}
BENCHMARK(put_samples);

void stack_of_64_samples(benchmark::State& state) {
    const FilmTile sample = filled({0, 0}, 1);
    for (auto _ : state) {
        BlockStack stack;
        for (std::uint64_t i = 0; i < 64; ++i) {
            FilmTile tile = stack.recycled(Tile, {i, 0}, AllChannels);
            tile.counts = sample.counts;
            tile.planes = sample.planes;
            stack.push(std::move(tile));
        }
        benchmark::DoNotOptimize(stack.take());
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * 64 * sample.pixel_count()));
}
BENCHMARK(stack_of_64_samples);

void encode_film(benchmark::State& state) {
    const wire::FilmPart part{.unit = UnitId{1}, .film = filled({0, 0}, 1)};
    for (auto _ : state) benchmark::DoNotOptimize(wire::encode(wire::BulkMessage(part)));
    set_bytes(state, part.film.byte_size());
}
BENCHMARK(encode_film);

void decode_film(benchmark::State& state) {
    const auto bytes =
        wire::encode(wire::BulkMessage(wire::FilmPart{.unit = UnitId{1}, .film = filled({0, 0}, 1)}));
    for (auto _ : state) benchmark::DoNotOptimize(wire::decode_bulk(bytes));
    set_bytes(state, bytes.size());
}
BENCHMARK(decode_film);

}  // namespace

BENCHMARK_MAIN();
