#pragma once

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "client/tools/progress_line.h"
#include "tests/bench/filters/scene_bench.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

// Measures scene after scene with a progress line: `measure(scene, progress)` returns what `show` gets, or nothing when it
// was stopped. False: stopped. Throws Error.
template <class Measure, class Show>
bool measure_each(const std::vector<std::string>& names, const std::filesystem::path& assets,
                  const Measure& measure, const Show& show) {
    for (const std::string& name : names) {
        const auto scene = load_scene(name, assets);
        if (!scene) throw scene.error();
        const auto measured = [&] {
            ProgressLine line;
            auto result = measure(*scene, BenchProgress{[&](const std::string& text) { line.show(text); },
                                                        [](const std::string& text) {
                                                            std::cerr << "tessera bench: " << text << "\n";
                                                        }});
            line.show("");
            return result;
        }();
        if (!measured) return false;
        show(*measured);
    }
    return true;
}

}  // namespace tessera::tools::bench
