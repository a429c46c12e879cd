#include "client/tools/render_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "client/tools/formatted.h"
#include "client/tools/host_info.h"
#include "mediator/picture/picture_encoder.h"

namespace tessera::tools {

namespace {

using Json = nlohmann::ordered_json;

double per_second(std::uint64_t amount, double time) {
    return time > 0.0 ? static_cast<double>(amount) / time : 0.0;
}

// The requested number if it was reached.
Json spp_value(const session::ViewRequest& request, const session::ViewSummary& result) {
    if (result.outcome == session::Outcome::Complete && !request.stop.has_steps()) return request.stop.spp;
    return samples_per_pixel(request, result);
}

Json nodes_value(const session::ViewSummary& result) {
    Json nodes = Json::array();
    for (const session::NodeSummary& node : result.nodes) {
        nodes.push_back({{"id", node.id.value},
                         {"pid", node.pid},
                         {"host", node.host},
                         {"kind", node.kind},
                         {"units", node.units},
                         {"samples", node.samples},
                         {"seconds_busy", node.seconds_busy}});
    }
    return nodes;
}

Json failed_tiles_value(const session::ViewSummary& result) {
    Json tiles = Json::array();
    for (const session::FailedTile& tile : result.failed_tiles) {
        tiles.push_back({{"x", tile.rect.x},
                         {"y", tile.rect.y},
                         {"width", tile.rect.width},
                         {"height", tile.rect.height},
                         {"samples", tile.samples},
                         {"message", tile.message}});
    }
    return tiles;
}

Json picture_value(const session::ViewSummary& result) {
    const session::PictureSummary& picture = result.picture;
    if (picture.encoding == session::PictureEncoding::None) return nullptr;
    Json passes = Json::array();
    for (const session::FilterPass& pass : picture.passes) {
        passes.push_back(
            {{"name", pass.name}, {"seconds", pass.seconds}, {"bytes_per_pixel", pass.bytes_per_pixel}});
    }
    return {{"filter", picture.filter},
            {"width", picture.width},
            {"height", picture.height},
            {"scale", picture.scale},
            {"seconds_filter", picture.seconds_filter},
            {"seconds_encode", picture.seconds_encode},
            {"seconds_predicted", picture.seconds_predicted},
            {"min_samples", result.min_samples},
            {"max_samples", result.max_samples},
            {"passes", passes},
            {"notes", picture.notes}};
}

// The noise or error of a picture that was to have one, and what ended it; or the noise of one that had a time.
std::string noise_text(const session::StopRule& stop, const session::ViewSummary& result) {
    const bool is_complete = result.outcome == session::Outcome::Complete;
    // Else samples have come since the last decision.
    const char* bound = is_complete ? "" : " or less";
    if (!stop.has_goal()) return result.noise > 0.0 ? formatted("noise %.3g or less", result.noise) : "";
    const bool is_error = stop.error > 0.0;
    const std::string name = is_error ? "error" : "noise";
    const double reached = is_error ? result.error : result.noise,
                 wanted = is_error ? stop.error : stop.noise;
    if (!stop.has_steps()) return name + " unknown: it takes 16 samples of a pixel, and --spp 32 or more";
    const bool is_known = reached > 0.0 || is_complete;  // 0: it is black
    if (is_known && reached <= wanted) return formatted("%s %.3g%s: as wanted", name.c_str(), reached, bound);
    return name + (is_known ? formatted(" %.3g%s: ", reached, bound) : std::string(" unknown: ")) +
           (result.outcome == session::Outcome::TimeUp ? "the time was up before it was as wanted"
            : is_complete                              ? "--spp was reached before it was as wanted"
                                                       : "the picture ended before it was as wanted");
}

std::string before_text(const session::ViewRequest& request, const session::ViewSummary& result) {
    if (result.samples_before == 0) return {};
    session::ViewSummary before;
    before.samples = result.samples_before;
    return formatted(", %.4g of them of the film that it continues", samples_per_pixel(request, before));
}

}  // namespace

double samples_per_pixel(const session::ViewRequest& request, const session::ViewSummary& result) {
    return static_cast<double>(result.samples) /
           static_cast<double>(std::max<std::size_t>(request.view.window.pixel_count(), 1));
}

std::string as_json(const RenderReport& report) {
    const session::ViewSummary& result = report.summary;
    const session::UnitCounts& units = result.units;
    const view::DisplayTransform& transform = report.request.display_transform;
    Json object{
        {"width", report.request.view.window.width},
        {"height", report.request.view.window.height},
        {"spp", spp_value(report.request, result)},
        {"seconds_total", report.seconds_total},
        {"seconds_render", result.seconds_render},
        {"first_picture_seconds", result.first_picture_seconds},
        {"rays", result.rays},
        {"mrays_per_second", per_second(result.rays, result.seconds_render) * 1e-6},
        {"samples_per_second", per_second(result.samples - result.samples_before, result.seconds_render)},
        {"triangles", result.triangles},
        {"instances", result.instances},
        {"lights", result.lights},
        {"nonfinite_samples", result.nonfinite_samples},
        {"samples_before", result.samples_before},
        {"noise", result.noise > 0.0 ? Json(result.noise) : Json()},
        {"error", result.error > 0.0 ? Json(result.error) : Json()},
        {"clamp",
         report.request.view.clamp_indirect > 0.0f ? Json(report.request.view.clamp_indirect) : Json()},
        {"peak_memory_bytes", peak_memory_bytes()},
        {"film_hash", report.film_hash},
        {"nodes", nodes_value(result)},
        {"units",
         {{"issued", units.issued},
          {"reissued", units.reissued},
          {"merged", units.merged},
          {"duplicate", units.duplicate},
          {"cancelled", units.cancelled},
          {"refused", units.refused},
          {"lost", units.lost}}},
        {"wire_bytes",
         {{"control", result.wire_bytes.control},
          {"blobs", result.wire_bytes.blobs},
          {"film", result.wire_bytes.film}}},
        {"failed_tiles", failed_tiles_value(result)},
        {"picture", picture_value(result)},
        {"view_transform", std::string(enumerator_name(transform.view_transform))},
        {"exposure", transform.exposure ? Json(*transform.exposure) : Json()},
    };
    if (!report.frame) return object.dump(2);
    object["frame"] = *report.frame;
    return object.dump();
}

std::string as_text(const RenderReport& report, const std::vector<std::string>& outputs) {
    const session::ViewSummary& result = report.summary;
    const Rect& window = report.request.view.window;
    std::string text;
    const auto line = [&](const char* format, auto... values) {
        char buffer[256];
        std::snprintf(buffer, sizeof buffer, format, values...);
        text += std::string(text.empty() ? "" : "\n") + buffer;
    };
    if (report.frame) {
        line("frame %u: %.2f s in all, %.2f s rendering, %.4g samples per pixel", *report.frame,
             report.seconds_total, result.seconds_render, samples_per_pixel(report.request, result));
        for (const std::string& output : outputs) text += ", wrote " + output;
        return text;
    }
    line("%dx%d pixels, %.4g samples per pixel%s", window.width, window.height,
         samples_per_pixel(report.request, result), before_text(report.request, result).c_str());
    line("%.2f s in all, %.2f s rendering: %.2f Mrays/s, %.3f Msamples/s", report.seconds_total,
         result.seconds_render, per_second(result.rays, result.seconds_render) * 1e-6,
         per_second(result.samples - result.samples_before, result.seconds_render) * 1e-6);
    if (const std::string noise = noise_text(report.request.stop, result); !noise.empty())
        line("%s", noise.c_str());
    if (const auto& picture = result.picture; picture.encoding != session::PictureEncoding::None) {
        line(
            "filter %s: %.1f ms, encoding %.1f ms%s", picture.filter.c_str(), picture.seconds_filter * 1e3,
            picture.seconds_encode * 1e3,
            picture.seconds_predicted > 0.0
                ? (" (" + std::to_string(std::lround(picture.seconds_predicted * 1e3)) + " ms were reserved)")
                      .c_str()
                : "");
        for (const std::string& note : picture.notes) line("%s", note.c_str());
    }
    if (const auto& transform = report.request.display_transform; transform.exposure)
        line("view transform %s", picture::describe(transform, report.custom_view).c_str());
    std::set<std::string> kinds;
    for (const session::NodeSummary& node : result.nodes) kinds.insert(node.kind);
    if (report.request.view.clamp_indirect > 0.0f) {
        line("biased: --clamp %g cuts indirect light, so that the picture is too dark",
             double(report.request.view.clamp_indirect));
    }
    line("%zu node%s took part", result.nodes.size(), result.nodes.size() == 1 ? "" : "s");
    for (const std::string& kind : kinds) line("  %s", kind.c_str());
    if (result.nonfinite_samples != 0) {
        line("%llu samples were not finite and were discarded",
             static_cast<unsigned long long>(result.nonfinite_samples));
    }
    for (const std::string& output : outputs) text += "\nwrote " + output;
    return text;
}

}  // namespace tessera::tools
