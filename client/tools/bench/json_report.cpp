#include "client/tools/bench/json_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tessera::tools::bench {

namespace {

using Json = nlohmann::ordered_json;

Json estimate(const Estimate& value) {
    return {{"value", value.value}, {"standard_error", value.deviation}};
}

// null: the error is below what the references can resolve.
Json ratio(const Ratio& value) {
    if (value.value == 0.0) return nullptr;
    return {{"value", value.value}, {"measured", value.is_measured}};
}

Json row_json(const Row& row) {
    Json passes = Json::array();
    for (const PassTime& pass : row.time.passes) {
        passes.push_back({{"name", pass.name},
                          {"milliseconds", pass.seconds * 1e3},
                          {"bytes_per_pixel", pass.bytes_per_pixel}});
    }
    return {{"filter", row.filter},
            {"spp", row.spp},
            {"relmse", estimate(row.errors.relmse)},
            {"mse", estimate(row.errors.mse)},
            {"flip_mean", row.seen.flip},
            {"ssim", row.seen.ssim},
            {"filter_milliseconds", row.time.seconds * 1e3},
            {"sampling_milliseconds", row.sampling_seconds * 1e3},
            {"passes", passes},
            {"bytes_per_pixel", row.time.bytes_per_pixel},
            {"time_over_plain_copy", row.time.copy_ratio},
            {"relmse_over_unfiltered", row.to_unfiltered},
            {"equal_error_sample_ratio", ratio(row.equal_error)},
            {"equal_time_error_ratio", ratio(row.equal_time)},
            {"notes", row.notes}};
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
                        {"temporal_relmse", estimate(row.temporal)},
                        {"relmse", estimate(row.relmse)}});
    }
    return {{"views", path.views},
            {"degrees_per_view", path.degrees_per_view},
            {"reference_spp", path.reference_spp},
            {"rows", rows}};
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
    const Json object{{"software", results.software}, {"backend", results.backend},
                      {"threads", results.threads},   {"seconds", results.seconds},
                      {"filters", filters},           {"scenes", scenes},
                      {"notes", results.notes}};
    return object.dump(1);
}

}  // namespace tessera::tools::bench
