#include "tests/bench/filters/plan.h"

#include <algorithm>
#include <charconv>

#include "client/tools/host_info.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

namespace {

constexpr std::uint64_t MostSpp = 1u << 16;
// The large size is for times and crops; convergence is measured at the small one.
constexpr std::uint64_t MostSppLarge = 16, LargeReferenceSpp = 32;
constexpr std::uint64_t MostSppOnPath = 4;

tl::unexpected<Error> wrong(const std::string& option, const std::string& text) {
    return failure(ErrorCode::InvalidInput, option + ": " + text);
}

// "fdf:radius=4,prefilter=off,none": an item with a value but without a filter's name belongs to the previous
// filter.
std::vector<std::string> split_filters(const std::string& text) {
    std::vector<std::string> filters;
    for (const std::string& item : split_list(text)) {
        const bool is_value = item.find('=') != std::string::npos && item.find(':') == std::string::npos;
        if (is_value && !filters.empty()) {
            filters.back() += "," + item;
        } else {
            filters.push_back(item);
        }
    }
    return filters;
}

std::vector<std::uint64_t> up_to(const std::vector<std::uint64_t>& spp, std::uint64_t most) {
    std::vector<std::uint64_t> kept;
    std::copy_if(spp.begin(), spp.end(), std::back_inserter(kept),
                 [&](std::uint64_t n) { return n <= most; });
    return kept;
}

// All filters that this machine can run, or the named ones.
Expected<std::vector<filter::Choice>> choose_filters(const std::string& text,
                                                     std::span<const filter::FilterEntry> table,
                                                     std::vector<std::string>& left_out) {
    std::vector<filter::Choice> filters{*filter::parse_choice("none", table)};
    std::vector<std::string> names = split_filters(text);
    if (text.empty()) {
        for (const filter::FilterEntry& entry : table) names.emplace_back(entry.description.name);
    }
    for (const std::string& name : names) {
        auto choice = filter::parse_choice(name, table);
        if (!choice) return wrong("--filters", choice.error().what());
        if (const std::string why = filter::why_unavailable(*choice->entry); !why.empty()) {
            if (!text.empty()) return wrong("--filters", why);
            left_out.push_back(name + " is left out: " + why);
            continue;
        }
        const bool is_there = std::any_of(filters.begin(), filters.end(), [&](const filter::Choice& other) {
            return to_text(other) == to_text(*choice);
        });
        if (!is_there) filters.push_back(std::move(*choice));
    }
    return filters;
}

}  // namespace

Expected<std::vector<std::uint64_t>> parse_spp(const std::string& text) {
    std::vector<std::uint64_t> spp;
    for (const std::string& item : split_list(text)) {
        std::uint64_t value = 0;
        const auto result = std::from_chars(item.data(), item.data() + item.size(), value);
        if (result.ec != std::errc() || result.ptr != item.data() + item.size() || value == 0 ||
            value > MostSpp) {
            return wrong("--spp", "'" + item + "' is not a number of samples from 1 to " +
                                      std::to_string(MostSpp) + ": write 1,4,16,64");
        }
        spp.push_back(value);
    }
    std::sort(spp.begin(), spp.end());
    spp.erase(std::unique(spp.begin(), spp.end()), spp.end());
    if (spp.empty()) return wrong("--spp", "the list is empty: write 1,4,16,64");
    return spp;
}

Expected<BenchPlan> parse_options(const BenchOptions& options, std::span<const filter::FilterEntry> table) {
    BenchPlan plan;
    plan.output = options.output;
    plan.references =
        options.references.empty() ? plan.output / "references" : std::filesystem::path(options.references);
    plan.assets = options.assets;
    plan.jobs = options.jobs != 0 ? options.jobs : core_count();
    auto scenes = choose_scenes(options.scenes, plan.assets);
    if (!scenes) return wrong("--scenes", scenes.error().what());
    plan.scenes = std::move(*scenes);
    auto filters = choose_filters(options.filters, table, plan.left_out);
    if (!filters) return tl::unexpected(filters.error());
    plan.filters = std::move(*filters);

    auto spp = parse_spp(options.spp);
    if (!spp) return tl::unexpected(spp.error());
    const auto size = parse_size(options.size);
    if (!size) return wrong("--size", size.error().what());
    if (options.reference_spp == 0 || options.reference_spp > MostSpp) {
        return wrong("--reference-spp", "give a number from 1 to " + std::to_string(MostSpp));
    }
    if (options.quick) *spp = up_to(*spp, 64).empty() ? *spp : up_to(*spp, 64);
    plan.sizes.push_back(
        {*size, *spp,
         options.quick ? std::min<std::uint64_t>(options.reference_spp, 256) : options.reference_spp});
    if (options.large != "none" && !options.quick) {
        const auto large = parse_size(options.large);
        if (!large) return wrong("--large", std::string(large.error().what()) + ", or none");
        const auto large_spp = up_to(*spp, MostSppLarge);
        if (!large_spp.empty()) {
            plan.sizes.push_back({*large, large_spp, std::min(options.reference_spp, LargeReferenceSpp)});
        }
    }
    plan.path_spp = up_to(*spp, MostSppOnPath);
    plan.measures_speed = !options.quick;
    if (options.quick) plan.path_views = 8;
    return plan;
}

}  // namespace tessera::tools::bench
