#include "tests/bench/filters/json_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tessera::tools::bench {

namespace {

using Json = nlohmann::ordered_json;

Json estimate(const Estimate& value) {
    return {{"value", value.value}, {"standard_error", value.deviation}};
}

// null: the error is below the resolution of the references.
Json ratio_json(const Ratio& value) {
    if (value.value == 0.0) return nullptr;
    return {{"value", value.value}, {"measured", value.is_measured}};
}

Json relative_json(const RelativeToUnfiltered& value) {
    return {{"relmse_over_unfiltered", value.to_unfiltered},
            {"equal_error_sample_ratio", ratio_json(value.equal_error)},
            {"equal_time_error_ratio", ratio_json(value.equal_time)}};
}

Json passes_json(const FilterTime& time) {
    Json passes = Json::array();
    for (const PassTime& pass : time.passes) {
        passes.push_back({{"name", pass.name},
                          {"milliseconds", pass.seconds * 1e3},
                          {"bytes_per_pixel", pass.bytes_per_pixel}});
    }
    return passes;
}

Json row_json(const Row& row) {
    Json trimmed = relative_json(row.trimmed);
    trimmed["relmse"] = estimate(row.errors.relmse.trimmed);
    Json object{{"filter", row.filter},
                {"spp", row.spp},
                {"relmse", estimate(row.errors.relmse.all)},
                {"mse", estimate(row.errors.mse)},
                {"flip_mean", row.seen.flip},
                {"ssim", row.seen.ssim},
                {"specks", row.seen.specks},
                {"energy", row.seen.energy},
                {"filter_milliseconds", row.time.seconds * 1e3},
                {"sampling_milliseconds", row.sampling_seconds * 1e3},
                {"passes", passes_json(row.time)},
                {"bytes_per_pixel", row.time.bytes_per_pixel},
                {"time_over_plain_copy", row.time.copy_ratio}};
    object.update(relative_json(row.all));
    object["trimmed"] = trimmed;
    object["notes"] = row.notes;
    return object;
}

Json size_json(const SizeResult& size) {
    Json rows = Json::array();
    for (const Row& row : size.rows) rows.push_back(row_json(row));
    return {{"width", size.width},
            {"height", size.height},
            {"references",
             {{"count", 2},
              {"spp", size.reference_spp},
              {"noise_mse", size.noise_mse},
              {"noise_relmse", size.noise_relmse}}},
            {"copy_gigabytes_per_second", size.copy_bytes_per_second * 1e-9},
            {"rows", rows}};
}

Json path_json(const PathResult& path) {
    Json rows = Json::array();
    for (const PathRow& row : path.rows) {
        rows.push_back({{"filter", row.filter},
                        {"spp", row.spp},
                        {"temporal_relmse", estimate(row.temporal.all)},
                        {"relmse", estimate(row.relmse.all)},
                        {"trimmed",
                         {{"temporal_relmse", estimate(row.temporal.trimmed)},
                          {"relmse", estimate(row.relmse.trimmed)}}}});
    }
    return {{"views", path.views},
            {"degrees_per_view", path.degrees_per_view},
            {"reference_spp", path.reference_spp},
            {"rows", rows}};
}

Json speed_json(const SpeedResult& speed) {
    Json published = Json::array(), variants = Json::array();
    for (const SpeedRow& row : speed.published) {
        published.push_back({{"filter", row.filter},
                             {"width", row.width},
                             {"height", row.height},
                             {"milliseconds", row.seconds * 1e3},
                             {"published_milliseconds", row.published_seconds * 1e3},
                             {"published_hardware", row.hardware},
                             {"source", row.source}});
    }
    for (const VariantRow& row : speed.variants) {
        variants.push_back({{"filter", row.filter},
                            {"milliseconds", row.time.seconds * 1e3},
                            {"passes", passes_json(row.time)},
                            {"relmse", estimate(row.relmse.all)},
                            {"relmse_trimmed", estimate(row.relmse.trimmed)}});
    }
    return {{"scene", speed.scene}, {"width", speed.width}, {"height", speed.height},
            {"spp", SpeedSpp},      {"variants", variants}, {"published", published}};
}

}  // namespace

std::string as_json(const BenchResults& results) {
    Json filters = Json::array(), scenes = Json::array();
    for (const FilterInfo& filter : results.filters) {
        filters.push_back({{"filter", filter.text},
                           {"name", filter.name},
                           {"summary", filter.summary},
                           {"source", filter.source},
                           {"consistent", filter.is_consistent},
                           {"temporal", filter.is_temporal},
                           {"path_class", filter.path_class},
                           {"channels", filter.channels}});
    }
    for (const SceneResult& scene : results.scenes) {
        Json sizes = Json::array();
        for (const SizeResult& size : scene.sizes) sizes.push_back(size_json(size));
        scenes.push_back({{"name", scene.name},
                          {"kind", scene.kind},
                          {"summary", scene.summary},
                          {"content", scene.content},
                          {"sizes", sizes},
                          {"camera_path", path_json(scene.path)}});
    }
    const Json object{{"software", results.software},
                      {"backend", results.backend},
                      {"threads", results.threads},
                      {"seconds", results.seconds},
                      {"filters", filters},
                      {"scenes", scenes},
                      {"speed", results.speed.scene.empty() ? Json(nullptr) : speed_json(results.speed)},
                      {"notes", results.notes}};
    return object.dump(1);
}

}  // namespace tessera::tools::bench
