#include "tests/bench/transport/transport_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "client/tools/markup.h"
#include "tests/bench/filters/html_page.h"
#include "tests/bench/filters/svg_plot.h"

namespace tessera::tools::bench {

namespace {

using Json = nlohmann::ordered_json;

// Share of the samples of which the light is reported.
constexpr double Brightest = 1e-3;

const TransportCurve* find(const TransportScene& scene, const std::string& renderer) {
    const auto found = std::ranges::find(scene.curves, renderer, &TransportCurve::renderer);
    return found == scene.curves.end() ? nullptr : &*found;
}

double samples_per_second(const TransportPoint& point, Size size) {
    return point.seconds > 0.0 ? double(point.spp) * double(size.width) * double(size.height) / point.seconds
                               : 0.0;
}

// Time to equal error over that of Cycles; 0: unknown.
double over_cycles(const TransportScene& scene, const TransportCurve& curve) {
    const TransportCurve* const cycles = find(scene, "cycles");
    return cycles == nullptr || cycles == &curve ? 0.0 : time_to_equal_error(curve, *cycles);
}

Json null_if_zero(double value) {
    return value == 0.0 ? Json() : Json(value);
}

// Exponents of the bins that have samples, with their counts.
Json histogram_json(const LuminanceHistogram& samples) {
    Json bins = Json::object();
    for (std::size_t i = 0; i < samples.bins().size(); ++i) {
        if (samples.bins()[i] > 0)
            bins[std::to_string(LuminanceHistogram::First + int(i))] = samples.bins()[i];
    }
    return {{"samples", samples.samples()}, {"black", samples.black()}, {"log2_luminance", bins}};
}

// Of paths up to each length; whole ones come last.
Json depths_json(const std::vector<PathDepth>& depths) {
    Json all = Json::array();
    for (const PathDepth& depth : depths)
        all.push_back({{"bounces", depth.bounces},
                       {"light", depth.light},
                       {"noise", depth.noise},
                       {"seconds", depth.seconds}});
    return all;
}

Json curve_json(const TransportScene& scene, const TransportCurve& curve, const TransportPlan& plan) {
    Json points = Json::array();
    for (const TransportPoint& point : curve.points) {
        const double rate = samples_per_second(point, plan.size);
        points.push_back({{"spp", point.spp},
                          {"seconds", point.seconds},
                          {"relmse", point.relmse.value},
                          {"relmse_standard_error", point.relmse.deviation},
                          {"trimmed_relmse", point.trimmed.value},
                          {"hdr_flip", point.flip},
                          {"light", point.light},
                          {"light_standard_error", point.light_deviation},
                          {"rays_per_sample", null_if_zero(point.rays)},
                          {"msamples_per_second", rate * 1e-6},
                          {"mrays_per_second", null_if_zero(rate * point.rays * 1e-6)}});
    }
    return {{"renderer", curve.renderer},
            {"first_picture_seconds", curve.first_picture_seconds},
            {"memory_bytes", null_if_zero(curve.memory_bytes)},
            {"slope", null_if_zero(slope(curve, SlopeFromSpp))},
            {"time_to_equal_error_over_cycles", null_if_zero(over_cycles(scene, curve))},
            {"light_in_brightest_permille", null_if_zero(curve.samples.light_in_brightest(Brightest))},
            {"histogram", curve.samples.samples() == 0 ? Json() : histogram_json(curve.samples)},
            {"depths", depths_json(curve.depths)},
            {"points", points}};
}

std::string or_dash(double value, const char* format) {
    return value == 0.0 ? "-" : fmt::format(fmt::runtime(format), value);
}

std::string table(const TransportScene& scene, const TransportPlan& plan) {
    std::string html =
        "<div "
        "class=\"scroll\"><table><tr><th>renderer</th><th>spp</th><th>seconds</th><th>relMSE</"
        "th><th>trimmed</th>"
        "<th>HDR-FLIP</th><th>light</th><th>rays a sample</th><th>Mrays/s</th><th>Msamples/s</th></tr>\n";
    for (const TransportCurve& curve : scene.curves) {
        bool is_first = true;
        for (const TransportPoint& point : curve.points) {
            const double rate = samples_per_second(point, plan.size);
            html += fmt::format(
                "<tr{}><td>{}</td><td>{}</td><td>{:.3g}</td><td>{:.3g}{}</td><td>{:.3g}</td><td>{}</"
                "td><td>{}</td><td>{}"
                "</td><td>{}</td><td>{:.3f}</td></tr>\n",
                is_first ? " class=\"first\"" : "", escaped(curve.renderer), point.spp, point.seconds,
                point.relmse.value, fmt::format(" \xC2\xB1 {:.1g}", point.relmse.deviation),
                point.trimmed.value, or_dash(point.flip, "{:.4f}"),
                fmt::format("{:.4f} \xC2\xB1 {:.4f}", point.light, point.light_deviation),
                or_dash(point.rays, "{:.2f}"), or_dash(rate * point.rays * 1e-6, "{:.2f}"), rate * 1e-6);
            is_first = false;
        }
    }
    return html + "</table></div>\n";
}

// Error over samples or over seconds, a line for each renderer.
Plot plot_of(const TransportScene& scene, bool over_time) {
    Plot plot{scene.name, over_time ? "seconds" : "samples per pixel", "relMSE", {}};
    for (std::size_t i = 0; i < scene.curves.size(); ++i) {
        PlotSeries series{scene.curves[i].renderer, line_color(i), {}};
        for (const TransportPoint& point : scene.curves[i].points)
            series.points.emplace_back(over_time ? point.seconds : double(point.spp), point.relmse.value);
        plot.series.push_back(std::move(series));
    }
    return plot;
}

std::string plots(const TransportScene& scene) {
    std::string html = "<div class=\"plots\">\n" + as_svg(plot_of(scene, false)) + "\n" +
                       as_svg(plot_of(scene, true)) + "</div>\n<p class=\"legend\">";
    for (std::size_t i = 0; i < scene.curves.size(); ++i)
        html += "<span><i style=\"background:" + line_color(i) + "\"></i>" +
                escaped(scene.curves[i].renderer) + "</span>";
    return html + "</p>\n";
}

// Noise, light and time of paths by their length, of the curves that know them.
std::string depth_table(const TransportScene& scene) {
    std::string html;
    for (const TransportCurve& curve : scene.curves) {
        if (curve.depths.empty()) continue;
        const PathDepth& whole = curve.depths.back();
        html += fmt::format(
            "<p>{}, paths that end early, in percent of whole paths:</p>\n<div class=\"scroll\"><table>"
            "<tr><th>bounces</th><th>light</th><th>noise</th><th>time</th></tr>\n",
            escaped(curve.renderer));
        for (const PathDepth& depth : curve.depths)
            html += fmt::format(
                "<tr><td>{}</td><td>{:.0f}</td><td>{}</td><td>{:.0f}</td></tr>\n", depth.bounces,
                100.0 * depth.light / whole.light,
                whole.noise > 0.0 ? fmt::format("{:.0f}", 100.0 * depth.noise / whole.noise) : "-",
                100.0 * depth.seconds / whole.seconds);
        html += "</table></div>\n";
    }
    return html;
}

std::string summary(const std::vector<TransportScene>& scenes) {
    std::string html =
        "<div class=\"scroll\"><table><tr><th>scene</th><th>renderer</th><th>slope</th><th>time to equal "
        "error over "
        "Cycles</th><th>light in 0.1 % of the samples</th><th>first picture, s</th><th>memory, "
        "MiB</th></tr>\n";
    for (const TransportScene& scene : scenes) {
        for (const TransportCurve& curve : scene.curves) {
            html += fmt::format(
                "<tr{}><td>{}</td><td>{}</td><td>{:.2f}</td><td>{}</td><td>{}</td><td>{:.2f}</td><td>{}</"
                "td></tr>\n",
                &curve == &scene.curves.front() ? " class=\"first\"" : "", escaped(scene.name),
                escaped(curve.renderer), slope(curve, SlopeFromSpp),
                or_dash(over_cycles(scene, curve), "{:.2f}"),
                or_dash(100.0 * curve.samples.light_in_brightest(Brightest), "{:.1f} %"),
                curve.first_picture_seconds, or_dash(curve.memory_bytes / (1 << 20), "{:.0f}"));
        }
    }
    return html + "</table></div>\n";
}

}  // namespace

double mean_time_to_equal_error(const std::vector<TransportScene>& scenes, const std::string& backend) {
    double sum = 0.0, count = 0.0;
    for (const TransportScene& scene : scenes) {
        const TransportCurve* const curve = find(scene, backend);
        const double ratio = curve == nullptr ? 0.0 : over_cycles(scene, *curve);
        if (!(ratio > 0.0)) continue;
        sum += std::log(ratio);
        count += 1.0;
    }
    return count > 0.0 ? std::exp(sum / count) : 0.0;
}

std::string transport_text(const TransportScene& scene, const TransportPlan& plan) {
    std::string text =
        fmt::format("{}\n  {:<8} {:>5} {:>8}  {:>9} {:>9} {:>7}  {:>7} {:>6}  {:>5} {:>7} {:>9}\n",
                    scene.name, "renderer", "spp", "seconds", "relMSE", "trimmed", "FLIP", "light", "+-",
                    "rays", "Mrays/s", "Msamples/s");
    for (const TransportCurve& curve : scene.curves) {
        for (const TransportPoint& point : curve.points) {
            const double rate = samples_per_second(point, plan.size);
            text += fmt::format(
                "  {:<8} {:>5} {:>8.3f}  {:>9.3g} {:>9.3g} {:>7.4f}  {:>7.4f} {:>6.4f}  {:>5} {:>7} "
                "{:>9.3f}\n",
                curve.renderer, point.spp, point.seconds, point.relmse.value, point.trimmed.value, point.flip,
                point.light, point.light_deviation, or_dash(point.rays, "{:.2f}"),
                or_dash(rate * point.rays * 1e-6, "{:.2f}"), rate * 1e-6);
        }
        text += fmt::format("  {:<8} slope {:.2f}, first picture after {:.2f} s", curve.renderer,
                            slope(curve, SlopeFromSpp), curve.first_picture_seconds);
        if (curve.memory_bytes > 0.0) text += fmt::format(", {:.0f} MiB", curve.memory_bytes / (1 << 20));
        if (const double ratio = over_cycles(scene, curve); ratio > 0.0)
            text += fmt::format(", time to equal error over Cycles {:.2f}", ratio);
        if (const double light = curve.samples.light_in_brightest(Brightest); light > 0.0)
            text += fmt::format(", {:.1f} % of the light in 0.1 % of the samples", 100.0 * light);
        text += "\n";
    }
    return text;
}

std::string transport_json(const std::vector<TransportScene>& scenes, const TransportPlan& plan) {
    Json all = Json::array();
    for (const TransportScene& scene : scenes) {
        Json curves = Json::array();
        for (const TransportCurve& curve : scene.curves) curves.push_back(curve_json(scene, curve, plan));
        all.push_back({{"scene", scene.name}, {"kind", scene.kind}, {"curves", curves}});
    }
    Json means = Json::object();
    for (const std::string& backend : plan.backends)
        means[backend] = null_if_zero(mean_time_to_equal_error(scenes, backend));
    return Json{{"width", plan.size.width},
                {"height", plan.size.height},
                {"seeds", plan.seeds},
                {"threads", plan.jobs},
                {"reference_spp", plan.reference_spp},
                {"mean_time_to_equal_error_over_cycles", means},
                {"scenes", all}}
        .dump(1);
}

std::string transport_html(const std::vector<TransportScene>& scenes, const TransportPlan& plan) {
    std::string html =
        "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width\"><title>Light transport: error against "
        "time</title>\n"
        "<style>" +
        std::string(page_style()) + "</style></head>\n<body>\n<h1>Light transport: error against time</h1>\n";
    html += fmt::format(
        "<p>Unfiltered pictures of {}x{} pixels, {} threads, means over {} films. relMSE is the mean of (F - "
        "R1)(F - R2) over "
        "two independent references of {} samples, which excludes their noise; after \xC2\xB1 is the "
        "standard error due to "
        "it. \"light\" is the mean luminance over that of the references. Cycles has materials and so "
        "references of its own. Time to equal error is relMSE times seconds, at the most "
        "samples of "
        "each.</p>\n",
        plan.size.width, plan.size.height, plan.jobs, plan.seeds, plan.reference_spp);
    for (const std::string& backend : plan.backends) {
        if (const double mean = mean_time_to_equal_error(scenes, backend); mean > 0.0)
            html +=
                fmt::format("<p>Time to equal error of {} over Cycles, geometric mean: <b>{:.2f}</b></p>\n",
                            escaped(backend), mean);
    }
    html += summary(scenes);
    for (const TransportScene& scene : scenes)
        html += "<h2>" + escaped(scene.name) + "</h2>\n<p>" + escaped(scene.summary) + "</p>\n" +
                plots(scene) + table(scene, plan) + depth_table(scene);
    return html + "</body>\n</html>\n";
}

std::string transport_svg(const std::vector<TransportScene>& scenes) {
    constexpr std::size_t Width = 520, Height = 340, Columns = 2, Legend = 30;
    const std::size_t rows = (scenes.size() + Columns - 1) / Columns;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">\n<style>text {{ font: 11px "
        "sans-serif; fill: #333; }} "
        "text.title {{ font-size: 13px; font-weight: bold; }} .grid {{ stroke: #e2e2e2; }} .line path {{ "
        "stroke-width: 1.6; fill: "
        "none; }} .line circle {{ stroke: none; }}</style>\n<rect width=\"100%\" height=\"100%\" "
        "fill=\"#fff\"/>\n",
        Width * Columns, Legend + Height * rows);
    if (!scenes.empty()) {
        for (std::size_t i = 0; i < scenes.front().curves.size(); ++i)
            svg += fmt::format("<text x=\"{}\" y=\"20\" style=\"fill:{}\">\xE2\x80\x94 {}</text>\n",
                               62 + 110 * i, line_color(i), escaped(scenes.front().curves[i].renderer));
    }
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const std::string plot = as_svg(plot_of(scenes[i], true));
        svg += fmt::format("<svg x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}\n", Width * (i % Columns),
                           Legend + Height * (i / Columns), Width, Height,
                           plot.substr(std::string("<svg").size()));
    }
    return svg + "</svg>\n";
}

}  // namespace tessera::tools::bench
