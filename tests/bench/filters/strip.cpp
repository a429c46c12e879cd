#include "tests/bench/filters/strip.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/tools/canvas.h"
#include "client/tools/formatted.h"
#include "mediator/display/pixel_font.h"
#include "mediator/picture/png_writer.h"

namespace tessera::tools::bench {

namespace {

constexpr std::uint32_t Columns = 4, Gap = 6;

std::uint64_t distance_to_four(std::uint64_t spp) {
    return spp > 4 ? spp - 4 : 4 - spp;
}

// At the same number of samples, those with a crop.
std::vector<const Row*> strip_rows(const SizeResult& size) {
    std::vector<const Row*> rows;
    for (const Row& row : size.rows) {
        if (row.crop.empty()) continue;
        if (!rows.empty() && distance_to_four(row.spp) < distance_to_four(rows.front()->spp)) rows.clear();
        if (rows.empty() || rows.front()->spp == row.spp) rows.push_back(&row);
    }
    return rows;
}

// How much filters help there: the mean over them of log(unfiltered error over error).
double gain(const SceneResult& scene) {
    double sum = 0.0;
    const std::vector<const Row*> rows = strip_rows(scene.sizes.back());
    for (const Row* row : rows) {
        if (row->trimmed.to_unfiltered > 0.0) sum -= std::log(row->trimmed.to_unfiltered);
    }
    return rows.empty() ? -1e9 : sum / static_cast<double>(rows.size());
}

}  // namespace

Strip make_strip(const BenchResults& results) {
    const auto scene =
        std::max_element(results.scenes.begin(), results.scenes.end(),
                         [](const SceneResult& a, const SceneResult& b) { return gain(a) < gain(b); });
    if (scene == results.scenes.end()) return {};
    const SizeResult& size = scene->sizes.back();
    const std::vector<const Row*> rows = strip_rows(size);
    if (rows.empty()) return {};

    struct Cell {
        const std::vector<std::uint8_t>& crop;
        std::string name, numbers;
    };
    std::vector<Cell> cells;
    const auto spp = static_cast<unsigned long long>(rows.front()->spp);
    Strip strip;
    strip.table =
        formatted("%s at %ux%u, %llu samples per pixel, %u threads.\n\n", scene->name.c_str(), size.width,
                  size.height, spp, results.threads) +
        "| filter | relMSE, trimmed | relMSE | FLIP | ms | equivalent spp |\n|---|---|---|---|---|---|\n";
    for (const Row* row : rows) {
        const double ms = row->time.seconds * 1e3;
        cells.push_back({row->crop, row->filter,
                         formatted("relMSE %.2g  %.3g ms", row->errors.relmse.trimmed.value, ms)});
        strip.table += formatted("| %s | %.3g | %.3g | %.3f | %.3g | %.3g x |\n", row->filter.c_str(),
                                 row->errors.relmse.trimmed.value, row->errors.relmse.all.value,
                                 row->seen.flip, ms, row->trimmed.equal_error.value);
    }
    cells.push_back({size.reference_crop, "reference", formatted("%llu spp", 2ull * size.reference_spp)});

    const auto count = static_cast<std::uint32_t>(cells.size());
    const std::uint32_t lines = (count + Columns - 1) / Columns, across = std::min(count, Columns);
    std::size_t longest = 1;
    for (const Cell& cell : cells) longest = std::max({longest, cell.name.size(), cell.numbers.size()});
    const std::uint32_t scale =
        std::clamp(size.crop_width / (static_cast<std::uint32_t>(longest) * display::GlyphAdvance), 1u, 2u);
    const std::uint32_t line_height = (display::GlyphHeight + 2) * scale;
    const std::uint32_t cell_width = size.crop_width + Gap,
                        cell_height = size.crop_height + 2 * line_height + Gap;
    Canvas canvas(across * cell_width + Gap, lines * cell_height + Gap, 255);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t left = Gap + i % Columns * cell_width, top = Gap + i / Columns * cell_height;
        canvas.paste(cells[i].crop, size.crop_width, left, top);
        draw_text(canvas, left, top + size.crop_height + 3, scale, cells[i].name);
        draw_text(canvas, left, top + size.crop_height + 3 + line_height, scale, cells[i].numbers);
    }
    strip.png = picture::encode_png(canvas.width, canvas.height, canvas.rgb);
    return strip;
}

}  // namespace tessera::tools::bench
