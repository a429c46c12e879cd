#include "tests/bench/filters/html_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/tools/formatted.h"
#include "client/tools/markup.h"
#include "tests/bench/filters/advice.h"
#include "tests/bench/filters/svg_plot.h"

namespace tessera::tools::bench {

namespace {

std::string cell(const std::string& text, const char* style = "") {
    return (*style ? "<td class=\"" + std::string(style) + "\">" : "<td>") + text + "</td>";
}

std::string ratio(const Ratio& value) {
    if (value.value == 0.0) return "\xE2\x80\x93";
    return formatted(value.is_measured ? "%.3g" : "(%.3g)", value.value);
}

std::string heading(const std::string& title, const std::string& how_to_read) {
    return "<h3>" + title + "</h3>\n<p class=\"note\">" + how_to_read + "</p>\n";
}

std::string table(const std::string& head, const std::string& body) {
    return "<div class=\"scroll\"><table><tr>" + head + "</tr>\n" + body + "</table></div>\n";
}

std::string heads(std::initializer_list<const char*> names) {
    std::string row;
    for (const char* name : names) row += "<th>" + std::string(name) + "</th>";
    return row;
}

}  // namespace

std::string filter_table(const BenchResults& results) {
    std::string body;
    for (const FilterInfo& filter : results.filters) {
        body += "<tr><td>" + escaped(filter.text) + "</td><td style=\"text-align:left\">" +
                escaped(filter.summary) + "</td><td>" + escaped(filter.source) + "</td><td>" +
                (filter.is_consistent ? "consistent" : "biased") +
                (filter.is_temporal ? ", keeps a history" : "") + "</td><td>" + escaped(filter.channels) +
                "</td></tr>\n";
    }
    return heading("The filters",
                   "Consistent: declared to converge, so that its error goes to 0 with the samples.") +
           table(heads({"filter", "what it does", "source", "", "reads"}), body);
}

std::string winner_table(const BenchResults& results) {
    const std::vector<std::uint64_t> counts = measured_spp(results);
    std::string head = "<th>scene</th><th>kind</th>", body;
    for (const std::uint64_t spp : counts) head += "<th>" + std::to_string(spp) + " spp</th>";
    for (const SceneResult& scene : results.scenes) {
        body += "<tr><td>" + escaped(scene.name) + "</td>" + cell(escaped(scene.kind));
        for (const std::uint64_t spp : counts) {
            const auto best = least_error(scene, spp);
            body +=
                cell(best ? escaped(best->row->filter) + " " + ratio(best->row->trimmed.equal_error) : "");
        }
        body += "</tr>\n";
    }
    return heading("Least error",
                   "The filter with the least relMSE, and its equivalent spp: how many times the "
                   "samples the "
                   "unfiltered picture needs for the same error. In brackets: extrapolated beyond the "
                   "measured curve, "
                   "where error "
                   "times samples is assumed constant.") +
           table(head, body);
}

std::string convergence_table(const BenchResults& results) {
    const std::vector<std::uint64_t> counts = measured_spp(results);
    std::string head = "<th>filter</th><th>described as</th>", body;
    for (const std::uint64_t spp : counts) head += "<th>" + std::to_string(spp) + " spp</th>";
    for (const FilterInfo& filter : results.filters) {
        if (filter.text == "none") continue;
        body += "<tr><td>" + escaped(filter.text) + "</td>" +
                cell(filter.is_consistent ? "consistent" : "biased");
        for (const std::uint64_t spp : counts) {
            double trimmed = 0.0, all = 0.0;
            for (const SceneResult& scene : results.scenes) {
                const Row* row = scene.sizes.front().find(filter.text, spp);
                if (!row) continue;
                trimmed = std::max(trimmed, row->trimmed.to_unfiltered);
                all = std::max(all, row->all.to_unfiltered);
            }
            body += cell(trimmed > 0.0 ? formatted("%.3g (%.3g)", trimmed, all) : "",
                         trimmed > ConsistencyLimit ? "bad" : "");
        }
        body += "</tr>\n";
    }
    return heading("Does it converge?",
                   "Trimmed relMSE over that of the unfiltered picture, in the scene where it is worst, at "
                   "the small "
                   "size; in brackets the same over all pixels. Red: more than 1.05.") +
           table(head, body);
}

std::string speed_table(const BenchResults& results) {
    std::string body;
    for (const FilterInfo& filter : results.filters) {
        const Row* slowest = nullptr;
        const SizeResult* at = nullptr;
        for (const SceneResult& scene : results.scenes) {
            for (const Row& row : scene.sizes.back().rows) {
                if (row.filter != filter.text || (slowest && row.time.seconds <= slowest->time.seconds))
                    continue;
                slowest = &row;
                at = &scene.sizes.back();
            }
        }
        if (!slowest) continue;
        const double megapixels = double(at->width) * double(at->height) * 1e-6;
        std::string passes;
        for (const PassTime& pass : slowest->time.passes) {
            passes += (passes.empty() ? "" : ", ") + pass.name + formatted(" %.2f ms", pass.seconds * 1e3);
        }
        body += "<tr><td>" + escaped(filter.text) + "</td>" +
                cell(formatted("%.2f", slowest->time.seconds * 1e3)) +
                cell(formatted("%.3g", slowest->time.seconds * 1e3 / megapixels)) +
                cell(formatted("%.0f", slowest->time.bytes_per_pixel)) +
                cell(formatted("%.2f", slowest->time.copy_ratio)) +
                "<td style=\"text-align:left;white-space:normal\">" + escaped(passes) + "</td></tr>\n";
    }
    const SizeResult& size = results.scenes.front().sizes.back();
    return heading(
               "Speed",
               formatted("At %ux%u on %u threads, in the scene and at the samples where it is slowest. A "
                         "plain copy of a working set of this size moves %.1f GB/s (read and written); the "
                         "last number is the filter's time over the time of copying as many bytes as its "
                         "passes move: 1 means memory bandwidth.",
                         size.width, size.height, results.threads, size.copy_bytes_per_second * 1e-9)) +
           table(heads({"filter", "ms", "ms per megapixel", "bytes per pixel", "time over copy", "passes"}),
                 body);
}

std::string method_tables(const SpeedResult& speed) {
    if (speed.scene.empty()) return {};
    std::string variants, published;
    for (const VariantRow& row : speed.variants) {
        variants += "<tr><td>" + escaped(row.filter) + "</td>" +
                    cell(formatted("%.2f", row.time.seconds * 1e3)) +
                    cell(formatted("%.4g", row.relmse.trimmed.value)) +
                    cell(formatted("%.4g", row.relmse.all.value)) + "</tr>\n";
    }
    for (const SpeedRow& row : speed.published) {
        published +=
            "<tr><td>" + escaped(row.filter) + "</td>" + cell(formatted("%ux%u", row.width, row.height)) +
            cell(formatted("%.1f", row.seconds * 1e3)) +
            cell(formatted("%.1f", row.published_seconds * 1e3)) + cell(row.hardware) + cell(row.source) +
            cell(formatted("%.2f", row.published_seconds / row.seconds)) + "</tr>\n";
    }
    const std::string where =
        formatted(" %s, %llu spp.", escaped(speed.scene).c_str(), static_cast<unsigned long long>(SpeedSpp));
    return heading("Methods",
                   "Each value of parameters that select a method; other parameters have their defaults." +
                       where + formatted(" %ux%u.", speed.width, speed.height)) +
           table(heads({"filter", "ms", "relMSE trimmed", "relMSE"}), variants) +
           heading("Compared with published times",
                   "Times published in the theses on their GPUs, at their sizes: quoted, not measured here." +
                       where) +
           table(heads({"filter", "size", "ms here", "ms published", "published hardware", "source",
                        "published over here"}),
                 published);
}

std::string size_table(const SizeResult& size) {
    std::string body;
    std::uint64_t before = 0;
    for (const Row& row : size.rows) {
        double least = row.errors.relmse.trimmed.value;
        for (const Row& other : size.rows) {
            if (other.spp == row.spp) least = std::min(least, other.errors.relmse.trimmed.value);
        }
        const bool is_best = row.errors.relmse.trimmed.value <= least;
        body += row.spp != before ? "<tr class=\"first\">" : "<tr>";
        before = row.spp;
        body += "<td>" + escaped(row.filter) + "</td>" + cell(std::to_string(row.spp)) +
                cell(formatted("%.4g", row.errors.relmse.trimmed.value), is_best ? "best" : "") +
                cell(formatted("\xC2\xB1%.1g", row.errors.relmse.trimmed.deviation)) +
                cell(formatted("%.3f", row.trimmed.to_unfiltered),
                     row.trimmed.to_unfiltered > ConsistencyLimit ? "bad" : "") +
                cell(ratio(row.trimmed.equal_error)) + cell(ratio(row.trimmed.equal_time)) +
                cell(formatted("%.4g", row.errors.relmse.all.value)) +
                cell(formatted("\xC2\xB1%.1g", row.errors.relmse.all.deviation)) +
                cell(formatted("%.3f", row.all.to_unfiltered),
                     row.all.to_unfiltered > ConsistencyLimit ? "bad" : "") +
                cell(ratio(row.all.equal_error)) + cell(ratio(row.all.equal_time)) +
                cell(formatted("%.4f", row.seen.flip)) + cell(formatted("%.4f", row.seen.ssim)) +
                cell(formatted("%.2f %%", 100.0 * row.seen.specks)) +
                cell(formatted("%.3f", row.seen.energy)) + cell(formatted("%.2f", row.time.seconds * 1e3)) +
                cell(formatted("%.1f", row.sampling_seconds * 1e3)) +
                cell(formatted("%.0f", row.time.bytes_per_pixel)) +
                cell(formatted("%.2f", row.time.copy_ratio)) + "</tr>\n";
    }
    const std::string head =
        "<th rowspan=\"2\">filter</th><th rowspan=\"2\">spp</th><th colspan=\"5\">trimmed relMSE</th>"
        "<th colspan=\"5\">relMSE of all pixels</th><th rowspan=\"2\">FLIP</th><th rowspan=\"2\">SSIM</th>"
        "<th rowspan=\"2\">specks</th><th rowspan=\"2\">energy</th>"
        "<th rowspan=\"2\">filter ms</th><th rowspan=\"2\">sampling ms</th><th rowspan=\"2\">bytes/px</th>"
        "<th rowspan=\"2\">time over copy</th></tr>\n<tr>" +
        heads({"value", "", "/ unfiltered", "equivalent spp", "equal-time error", "value", "", "/ unfiltered",
               "equivalent spp", "equal-time error"});
    return "<details" + std::string(size.reference_crop.empty() ? "" : " open") + "><summary>" +
           formatted("%ux%u", size.width, size.height) + "</summary><p class=\"note\">" +
           formatted(
               "Two references of %llu spp, each with a relMSE of %.2g from its own noise (half the mean "
               "square of "
               "their "
               "difference), which is not part of the errors below. Specks: pixels whose luminance differs "
               "from "
               "the median around them by more than 25 %% plus 1 %% of the mean, and does not in the "
               "references. "
               "Energy: mean luminance over the references'.",
               static_cast<unsigned long long>(size.reference_spp), size.noise_relmse) +
           "</p>" + table(head, body) + "</details>\n";
}

std::string path_table(const PathResult& path) {
    if (path.rows.empty()) return {};
    std::string body;
    std::uint64_t before = 0;
    const auto cells = [](const Estimate& value, bool is_best) {
        return cell(formatted("%.4g", value.value), is_best ? "best" : "") +
               cell(formatted("\xC2\xB1%.1g", value.deviation));
    };
    for (const PathRow& row : path.rows) {
        double least = row.temporal.trimmed.value;
        for (const PathRow& other : path.rows) {
            if (other.spp == row.spp) least = std::min(least, other.temporal.trimmed.value);
        }
        body += row.spp != before ? "<tr class=\"first\">" : "<tr>";
        before = row.spp;
        body += "<td>" + escaped(row.filter) + "</td>" + cell(std::to_string(row.spp)) +
                cells(row.temporal.trimmed, row.temporal.trimmed.value <= least) +
                cells(row.temporal.all, false) + cells(row.relmse.trimmed, false) +
                cells(row.relmse.all, false) + "</tr>\n";
    }
    return "<details><summary>camera path</summary><p class=\"note\">" +
           formatted(
               "%u views, %.2g degrees apart, new samples in each. Temporal relMSE: of the step from view to "
               "view "
               "against the references' step. relMSE: mean over the second half of the views.",
               path.views, path.degrees_per_view) +
           "</p>" +
           table(heads({"filter", "spp", "temporal, trimmed", "", "temporal, all pixels", "",
                        "relMSE, trimmed", "", "relMSE, all pixels", ""}),
                 body) +
           "</details>\n";
}

}  // namespace tessera::tools::bench
