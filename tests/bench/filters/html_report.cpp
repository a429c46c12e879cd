#include "tests/bench/filters/html_report.h"

#include <algorithm>
#include <cstdio>

#include "client/tools/markup.h"
#include "mediator/picture/png_writer.h"
#include "tests/bench/filters/advice.h"
#include "tests/bench/filters/html_page.h"
#include "tests/bench/filters/html_tables.h"
#include "tests/bench/filters/svg_plot.h"

namespace tessera::tools::bench {

namespace {

// The number of samples whose crops are shown side by side: 4, or the nearest that was measured.
std::uint64_t shown_spp(const SizeResult& size) {
    std::uint64_t best = 0;
    for (const Row& row : size.rows) {
        if (row.crop.empty()) continue;
        const auto distance = [](std::uint64_t n) { return n > 4 ? n - 4 : 4 - n; };
        if (best == 0 || distance(row.spp) < distance(best)) best = row.spp;
    }
    return best;
}

std::string image(const SceneResult& scene, const std::string& filter, const std::string& spp,
                  const std::string& caption, const std::vector<std::uint8_t>& crop) {
    const SizeResult& size = scene.sizes.back();
    const std::vector<std::byte> png = picture::encode_png(size.crop_width, size.crop_height, crop);
    return "<figure><img data-scene=\"" + escaped(scene.name) + "\" data-filter=\"" + escaped(filter) +
           "\" data-spp=\"" + spp + "\" alt=\"" + escaped(caption) + "\" src=\"data:image/png;base64," +
           base64(png) + "\"><figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

// One row of crops is open; those of other numbers of samples are collapsed.
std::string crops(const SceneResult& scene) {
    const SizeResult& size = scene.sizes.back();
    if (size.reference_crop.empty()) return {};
    const std::uint64_t open = shown_spp(size);
    std::string html = "<div class=\"crops\">\n";
    html += image(scene, "reference", "", "reference", size.reference_crop);
    std::vector<std::uint64_t> others;
    const auto add = [&](std::uint64_t spp) {
        for (const Row& row : size.rows) {
            if (row.spp != spp || row.crop.empty()) continue;
            char caption[160];
            std::snprintf(caption, sizeof caption, "%s, %llu spp, trimmed relMSE %.3g", row.filter.c_str(),
                          static_cast<unsigned long long>(spp), row.errors.relmse.trimmed.value);
            html += image(scene, row.filter, std::to_string(spp), caption, row.crop);
        }
    };
    add(open);
    html += "</div>\n";
    for (const Row& row : size.rows) {
        if (row.spp != open && !row.crop.empty() && (others.empty() || others.back() != row.spp))
            others.push_back(row.spp);
    }
    for (const std::uint64_t spp : others) {
        html += "<details><summary>crops at " + std::to_string(spp) + " spp</summary><div class=\"crops\">\n";
        add(spp);
        html += "</div></details>\n";
    }
    return html;
}

std::string plots(const BenchResults& results, const SceneResult& scene) {
    std::string html = "<div class=\"plots\">\n";
    const SizeResult& size = scene.sizes.front();
    const std::string at = " at " + std::to_string(size.width) + "x" + std::to_string(size.height);
    Plot by_spp{scene.name + ": error over samples" + at, "samples per pixel", "trimmed relMSE", {}};
    Plot by_time{scene.name + ": error over time" + at, "sampling and filter, ms", "trimmed relMSE", {}};
    for (std::size_t i = 0; i < results.filters.size(); ++i) {
        PlotSeries over_spp{results.filters[i].text, line_color(i), {}}, over_time = over_spp;
        for (const Row& row : size.rows) {
            if (row.filter != results.filters[i].text) continue;
            const double filter_seconds = row.filter == "none" ? 0.0 : row.time.seconds;
            over_spp.points.emplace_back(double(row.spp), row.errors.relmse.trimmed.value);
            over_time.points.emplace_back((row.sampling_seconds + filter_seconds) * 1e3,
                                          row.errors.relmse.trimmed.value);
        }
        by_spp.series.push_back(std::move(over_spp));
        by_time.series.push_back(std::move(over_time));
    }
    return html + as_svg(by_spp) + "\n" + as_svg(by_time) + "</div>\n";
}

std::string legend(const BenchResults& results) {
    std::string html = "<p class=\"legend\">";
    for (std::size_t i = 0; i < results.filters.size(); ++i) {
        html += "<span><i style=\"background:" + line_color(i) + "\"></i>" +
                escaped(results.filters[i].text) + "</span>";
    }
    return html + "</p>\n";
}

std::string comparison() {
    return R"(<h2>Compare</h2>
<p id="controls">Scene <select id="scene"></select> Samples <select id="spp"></select>
Left <select id="left"></select> Right <select id="right"></select>
<input id="split" type="range" min="0" max="100" step="0.1" value="50" aria-label="where left and right meet"></p>
<div id="stage"><img id="under" alt=""><img id="over" class="over" alt=""><b id="bar"></b>
<span id="name-left" style="left:4px"></span><span id="name-right" style="right:4px"></span></div>
)";
}

std::string scene_section(const BenchResults& results, const SceneResult& scene) {
    std::string html = "<h2>" + escaped(scene.name) + "</h2>\n<p>" + escaped(scene.summary) +
                       ". Kind: " + escaped(scene.kind) + ".</p>\n" + crops(scene) + plots(results, scene) +
                       legend(results);
    for (const SizeResult& size : scene.sizes) html += size_table(size);
    return html + path_table(scene.path);
}

std::string introduction(const BenchResults& results) {
    char line[400];
    std::snprintf(line, sizeof line, "%s, %zu scenes, %zu filters, %u threads, %s, %.0f s in all.",
                  escaped(results.software).c_str(), results.scenes.size(), results.filters.size(),
                  results.threads, escaped(results.backend).c_str(), results.seconds);
    std::string html =
        "<h1>Reconstruction filters: error against time</h1>\n<p>" + std::string(line) +
        " All filters use the same samples. Errors are unbiased: means of (F - R1)(F - R2) over two "
        "independent references, which excludes the references' own noise; the number after "
        "\xC2\xB1 is the standard error due to that noise. relMSE has epsilon 0.01 times the squared mean "
        "luminance. FLIP (mean, LDR) and SSIM compare the tone-mapped picture with the mean of both "
        "references. The trimmed relMSE excludes the 0.1 % of the pixels where the error is largest: one "
        "firefly in the "
        "dark or the edge of one lamp can dominate the rest. The recommendations use "
        "the trimmed relMSE; the "
        "tables have both.</p>\n";
    for (const std::string& note : results.notes) html += "<p class=\"note\">" + escaped(note) + "</p>\n";
    return html;
}

}  // namespace

std::string base64(std::span<const std::byte> bytes) {
    constexpr char Digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) text += k <= count ? Digits[group >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

std::string as_html(const BenchResults& results) {
    std::string html =
        "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width\">"
        "<title>Filters: error against time</title>\n<style>" +
        std::string(page_style()) + "</style></head>\n<body>\n" + introduction(results);
    html += "<h2>Which filter when</h2>\n<ul>\n";
    for (const std::string& sentence : advice(results)) html += "<li>" + escaped(sentence) + "</li>\n";
    html += "</ul>\n" + winner_table(results) + convergence_table(results) + speed_table(results) +
            method_tables(results.speed) + filter_table(results);
    html += comparison();
    for (const SceneResult& scene : results.scenes) html += scene_section(results, scene);
    return html + "<script>" + std::string(page_script()) + "</script>\n</body>\n</html>\n";
}

}  // namespace tessera::tools::bench
