#include "tests/bench/filters/advice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <set>

#include "client/tools/formatted.h"

namespace tessera::tools::bench {

namespace {

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
    }
    return text;
}

template <class Better>
std::optional<PlacedRow> best(const SceneResult& scene, std::uint64_t spp, const Better& better) {
    const std::vector<PlacedRow> rows = rows_at(scene, spp);
    if (rows.empty()) return std::nullopt;
    return *std::min_element(rows.begin(), rows.end(),
                             [&](const PlacedRow& a, const PlacedRow& b) { return better(*a.row, *b.row); });
}

// "pixel in room-1 and studio-1, fdf in cornell"
std::string winners(
    const BenchResults& results, std::uint64_t spp,
    const std::function<std::optional<PlacedRow>(const SceneResult&, std::uint64_t)>& best_of) {
    std::vector<std::pair<std::string, std::vector<std::string>>> by_filter;
    for (const SceneResult& scene : results.scenes) {
        const auto winner = best_of(scene, spp);
        if (!winner) continue;
        auto found = std::find_if(by_filter.begin(), by_filter.end(),
                                  [&](const auto& entry) { return entry.first == winner->row->filter; });
        if (found == by_filter.end()) found = by_filter.insert(found, {winner->row->filter, {}});
        found->second.push_back(scene.name + " (" + scene.kind + ")");
    }
    std::stable_sort(by_filter.begin(), by_filter.end(),
                     [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
    std::string text;
    for (const auto& [filter, scenes] : by_filter) {
        text += (text.empty() ? "" : "; ") + filter + " in " + listed(scenes);
    }
    return text;
}

void advise_on_convergence(const BenchResults& results, std::vector<std::string>& sentences) {
    std::vector<std::string> kept, broken;
    for (const Convergence& filter : convergence(results)) {
        if (filter.filter == "none") continue;
        if (filter.worst <= ConsistencyLimit) {
            kept.push_back(filter.filter + formatted(" (at most %.2f x)", filter.worst));
            continue;
        }
        std::uint64_t first = 0;
        for (const Convergence::Exceeded& limit : filter.exceeded) {
            if (first == 0 || limit.spp < first) first = limit.spp;
        }
        broken.push_back(
            filter.filter +
            formatted(" from %llu spp on in %s (%.3g x at worst)", static_cast<unsigned long long>(first),
                      filter.exceeded.size() == 1 ? filter.exceeded.front().scene.c_str()
                                                  : (std::to_string(filter.exceeded.size()) + " of " +
                                                     std::to_string(results.scenes.size()) + " scenes")
                                                        .c_str(),
                      filter.worst) +
            (filter.is_declared_consistent ? ", although it is declared consistent" : ""));
    }
    if (!kept.empty()) {
        sentences.push_back("Never more than 5 % worse than no filter, at 4 or more samples: " +
                            listed(kept) + ". These can stay on while a picture converges.");
    }
    if (!broken.empty()) {
        sentences.push_back("Worse than no filter, so switch them off for final pictures: " + listed(broken) +
                            ".");
    }
}

void advise_on_motion(const BenchResults& results, std::vector<std::string>& sentences) {
    std::map<std::uint64_t, std::map<std::string, std::pair<double, int>>> logs;
    for (const SceneResult& scene : results.scenes) {
        for (const PathRow& row : scene.path.rows) {
            if (!(row.temporal.trimmed.value > 0.0)) continue;
            auto& entry = logs[row.spp][row.filter];
            entry.first += std::log(row.temporal.trimmed.value);
            ++entry.second;
        }
    }
    for (const auto& [spp, filters] : logs) {
        const auto mean = [](const auto& entry) {
            return std::exp(entry.second.first / entry.second.second);
        };
        const auto calmest = std::min_element(
            filters.begin(), filters.end(), [&](const auto& a, const auto& b) { return mean(a) < mean(b); });
        const auto none = filters.find("none");
        if (none == filters.end() || calmest == none) continue;
        sentences.push_back(formatted(
            "While the camera moves, at %llu spp a view, %s flickers least: its steps from "
            "view to view have %.3g times less error than those of unfiltered pictures "
            "(geometric mean over the scenes).",
            static_cast<unsigned long long>(spp), calmest->first.c_str(), mean(*none) / mean(*calmest)));
    }
}

}  // namespace

std::vector<PlacedRow> rows_at(const SceneResult& scene, std::uint64_t spp) {
    for (auto size = scene.sizes.rbegin(); size != scene.sizes.rend(); ++size) {
        std::vector<PlacedRow> rows;
        for (const Row& row : size->rows) {
            if (row.spp == spp) rows.push_back({&*size, &row});
        }
        if (!rows.empty()) return rows;
    }
    return {};
}

std::vector<std::uint64_t> measured_spp(const BenchResults& results) {
    std::set<std::uint64_t> found;
    for (const SceneResult& scene : results.scenes) {
        for (const SizeResult& size : scene.sizes) {
            for (const Row& row : size.rows) found.insert(row.spp);
        }
    }
    return {found.begin(), found.end()};
}

std::optional<PlacedRow> least_error(const SceneResult& scene, std::uint64_t spp) {
    return best(scene, spp, [](const Row& a, const Row& b) {
        return a.errors.relmse.trimmed.value < b.errors.relmse.trimmed.value;
    });
}

std::optional<PlacedRow> best_for_time(const SceneResult& scene, std::uint64_t spp) {
    return best(scene, spp, [](const Row& a, const Row& b) {
        return a.trimmed.equal_time.value > b.trimmed.equal_time.value;
    });
}

std::vector<Convergence> convergence(const BenchResults& results) {
    std::vector<Convergence> found;
    for (const FilterInfo& filter : results.filters) {
        Convergence one{.filter = filter.text, .is_declared_consistent = filter.is_consistent};
        for (const SceneResult& scene : results.scenes) {
            std::uint64_t first = 0;
            for (const Row& row : scene.sizes.front().rows) {
                if (row.filter != filter.text || row.spp < 4) continue;
                if (row.trimmed.to_unfiltered > one.worst) {
                    one.worst = row.trimmed.to_unfiltered;
                    one.worst_scene = scene.name;
                    one.worst_spp = row.spp;
                }
                if (row.trimmed.to_unfiltered > ConsistencyLimit && first == 0) first = row.spp;
            }
            if (first != 0) one.exceeded.push_back({scene.name, first});
        }
        found.push_back(std::move(one));
    }
    return found;
}

std::vector<Standing> standings(const BenchResults& results, std::uint64_t spp) {
    std::vector<Standing> found;
    for (const FilterInfo& filter : results.filters) {
        double logs = 0.0, worst = 0.0;
        int count = 0;
        for (const SceneResult& scene : results.scenes) {
            for (const PlacedRow& placed : rows_at(scene, spp)) {
                const double ratio = placed.row->trimmed.equal_error.value;
                if (placed.row->filter != filter.text || !(ratio > 0.0)) continue;
                logs += std::log(ratio);
                worst = count == 0 ? ratio : std::min(worst, ratio);
                ++count;
            }
        }
        if (count > 0) found.push_back({filter.text, std::exp(logs / count), worst});
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Standing& a, const Standing& b) { return a.ratio > b.ratio; });
    return found;
}

std::vector<std::string> advice(const BenchResults& results) {
    std::vector<std::string> sentences;
    for (const std::uint64_t spp : measured_spp(results)) {
        if (spp > 64) continue;
        const auto n = static_cast<unsigned long long>(spp);
        const std::vector<Standing> ranking = standings(results, spp);
        if (ranking.empty()) continue;
        std::string text =
            formatted("At %llu spp the least error has: ", n) + winners(results, spp, least_error) + ". ";
        const Standing& first = ranking.front();
        if (first.filter == "none") {
            text += "Over all scenes no filter helps.";
        } else {
            text += formatted(
                "Over all scenes %s helps most: equivalent to %.3g times the samples (geometric mean; %.3g "
                "times where it helps least).",
                first.filter.c_str(), first.ratio, first.worst);
        }
        const std::string by_error = winners(results, spp, least_error);
        const std::string by_time = winners(results, spp, best_for_time);
        text += by_time == by_error ? " Including the filters' own time changes nothing."
                                    : " Including the filters' own time: " + by_time + ".";
        sentences.push_back(text);
    }
    advise_on_convergence(results, sentences);
    advise_on_motion(results, sentences);
    return sentences;
}

}  // namespace tessera::tools::bench
