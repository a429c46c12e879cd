#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "mediator/net/liveness.h"
#include "mediator/wire/blob_transfer.h"

namespace tessera::node {

// What a node does with the units it is rendering when it is asked to stop.
enum class Drain : std::uint8_t {
    HandBack,  // sends the samples rendered so far, within LeaveLimit
    Finish,    // renders them to the end
};
inline constexpr Duration LeaveLimit = std::chrono::seconds(3);

struct NodeSettings {
    std::string name = "node", host{}, software = "tessera";
    std::uint64_t pid = 0;
    std::string backend{};             // its name in the catalog
    bool reproducible = false;         // pinned to AVX2, or needs no pinning (design 1.6)
    std::uint32_t workers = 0;         // concurrent units; 0 = as many as the back-end recommends
    net::LivenessSettings liveness{};  // until the master's Welcome sets its interval
    wire::BlobLimits blob_limits{.bytes_total = std::uint64_t{1} << 60};  // total quota
    std::optional<std::filesystem::path> cache{};  // folder for blobs; none = no disk cache
    std::uint64_t cache_limit = 4ull << 30;        // bytes
    std::uint64_t store_limit =
        0;  // bytes of blobs above which unused ones are dropped; 0 = never (a shared store)
    Drain drain = Drain::HandBack;
};

struct NodeCounters {
    std::uint64_t samples = 0;  // of pixels, finished since the start
    std::uint64_t units_done = 0, units_released = 0;
    std::uint64_t malformed_messages = 0, resyncs = 0, reconnects = 0;
};

}  // namespace tessera::node
