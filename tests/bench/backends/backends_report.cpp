#include "tests/bench/backends/backends_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace tessera::tools::bench {

namespace {

using Json = nlohmann::ordered_json;

// 0: not measured.
double ratio(const BackendsScene& scene, const TargetResult& target, const Measure& measure) {
    const double first = scene.targets.front().measured.median(measure.key);
    return first > 0.0 ? target.measured.median(measure.key) / first : 0.0;
}

std::string quoted(const std::string& text) {
    std::string quoted_text = "\"";
    for (const char c : text) quoted_text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted_text + "\"";
}

}  // namespace

std::string as_table(const BackendsScene& scene) {
    std::ostringstream out;
    out << std::setprecision(3) << scene.name << ": " << scene.summary << ", " << scene.triangles
        << " triangles in " << scene.instances << " instances\n"
        << std::setw(32) << "";
    for (const TargetResult& target : scene.targets) {
        out << std::setw(12) << target.name << std::setw(9) << "";
    }
    out << "\n";
    for (const Measure& measure : BackendMeasures) {
        if (scene.targets.front().measured.all(measure.key).empty()) continue;
        out << std::left << std::setw(20) << measure.label << std::setw(12) << measure.unit << std::right;
        for (const TargetResult& target : scene.targets) {
            const double ratio_to_first = ratio(scene, target, measure);
            out << std::setw(12) << target.measured.median(measure.key) * measure.scale;
            if (ratio_to_first > 0.0 && &target != &scene.targets.front()) {
                out << std::setw(8) << ratio_to_first << "x";
            } else {
                out << std::setw(9) << "";
            }
        }
        out << "\n";
    }
    for (const TargetResult& target : scene.targets) {
        out << target.name << ": " << target.kind << "\n";
    }
    return out.str();
}

std::string as_csv(const BackendsResults& results) {
    std::ostringstream out;
    out << "scene,triangles,backend,kind,measure,unit,median,ratio\n";
    for (const BackendsScene& scene : results.scenes) {
        for (const TargetResult& target : scene.targets) {
            for (const Measure& measure : BackendMeasures) {
                if (target.measured.all(measure.key).empty()) continue;
                const double ratio_to_first = ratio(scene, target, measure);
                out << quoted(scene.name) << "," << scene.triangles << "," << target.name << ","
                    << quoted(target.kind) << "," << measure.key << "," << measure.unit << ","
                    << target.measured.median(measure.key) * measure.scale << ",";
                if (ratio_to_first > 0.0) out << ratio_to_first;
                out << "\n";
            }
        }
    }
    return out.str();
}

std::string as_json(const BackendsResults& results) {
    Json scenes = Json::array();
    for (const BackendsScene& scene : results.scenes) {
        Json targets = Json::array();
        for (const TargetResult& target : scene.targets) {
            Json measures = Json::object();
            for (const Measure& measure : BackendMeasures) {
                std::vector<double> all = target.measured.all(measure.key);
                if (all.empty()) continue;
                for (double& value : all) value *= measure.scale;
                const double ratio_to_first = ratio(scene, target, measure);
                measures[std::string(measure.key)] = {
                    {"unit", measure.unit},
                    {"median", target.measured.median(measure.key) * measure.scale},
                    {"ratio", ratio_to_first > 0.0 ? Json(ratio_to_first) : Json()},
                    {"all", all}};
            }
            targets.push_back({{"backend", target.name}, {"kind", target.kind}, {"measures", measures}});
        }
        scenes.push_back({{"scene", scene.name},
                          {"summary", scene.summary},
                          {"triangles", scene.triangles},
                          {"instances", scene.instances},
                          {"backends", targets}});
    }
    return Json{{"software", results.software}, {"threads", results.threads}, {"width", results.width},
                {"height", results.height},     {"spp", results.spp},         {"rays", results.rays},
                {"repeat", results.repeat},     {"seconds", results.seconds}, {"scenes", scenes}}
        .dump(2);
}

}  // namespace tessera::tools::bench
