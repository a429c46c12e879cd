#include "tests/bench/backends/backends_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace tessera::tools::bench {

namespace {

using Json = nlohmann::ordered_json;

// 0: there is none.
double ratio(const BackendsScene& scene, const ContenderResult& contender, const Measure& measure) {
    const double first = scene.contenders.front().measured.median(measure.key);
    return first > 0.0 ? contender.measured.median(measure.key) / first : 0.0;
}

std::string quoted(const std::string& text) {
    std::string made = "\"";
    for (const char c : text) made += c == '"' ? std::string("\"\"") : std::string(1, c);
    return made + "\"";
}

}  // namespace

std::string as_table(const BackendsScene& scene) {
    std::ostringstream out;
    out << std::setprecision(3) << scene.name << ": " << scene.summary << ", " << scene.triangles
        << " triangles in " << scene.instances << " instances\n"
        << std::setw(32) << "";
    for (const ContenderResult& contender : scene.contenders) {
        out << std::setw(12) << contender.name << std::setw(9) << "";
    }
    out << "\n";
    for (const Measure& measure : BackendMeasures) {
        if (scene.contenders.front().measured.all(measure.key).empty()) continue;
        out << std::left << std::setw(20) << measure.label << std::setw(12) << measure.unit << std::right;
        for (const ContenderResult& contender : scene.contenders) {
            const double share = ratio(scene, contender, measure);
            out << std::setw(12) << contender.measured.median(measure.key) * measure.scale;
            if (share > 0.0 && &contender != &scene.contenders.front()) {
                out << std::setw(8) << share << "x";
            } else {
                out << std::setw(9) << "";
            }
        }
        out << "\n";
    }
    for (const ContenderResult& contender : scene.contenders) {
        out << contender.name << ": " << contender.kind << "\n";
    }
    return out.str();
}

std::string as_csv(const BackendsResults& results) {
    std::ostringstream out;
    out << "scene,triangles,backend,kind,measure,unit,median,ratio\n";
    for (const BackendsScene& scene : results.scenes) {
        for (const ContenderResult& contender : scene.contenders) {
            for (const Measure& measure : BackendMeasures) {
                if (contender.measured.all(measure.key).empty()) continue;
                const double share = ratio(scene, contender, measure);
                out << quoted(scene.name) << "," << scene.triangles << "," << contender.name << ","
                    << quoted(contender.kind) << "," << measure.key << "," << measure.unit << ","
                    << contender.measured.median(measure.key) * measure.scale << ",";
                if (share > 0.0) out << share;
                out << "\n";
            }
        }
    }
    return out.str();
}

std::string as_json(const BackendsResults& results) {
    Json scenes = Json::array();
    for (const BackendsScene& scene : results.scenes) {
        Json contenders = Json::array();
        for (const ContenderResult& contender : scene.contenders) {
            Json measures = Json::object();
            for (const Measure& measure : BackendMeasures) {
                std::vector<double> all = contender.measured.all(measure.key);
                if (all.empty()) continue;
                for (double& value : all) value *= measure.scale;
                const double share = ratio(scene, contender, measure);
                measures[std::string(measure.key)] = {
                    {"unit", measure.unit},
                    {"median", contender.measured.median(measure.key) * measure.scale},
                    {"ratio", share > 0.0 ? Json(share) : Json()},
                    {"all", all}};
            }
            contenders.push_back(
                {{"backend", contender.name}, {"kind", contender.kind}, {"measures", measures}});
        }
        scenes.push_back({{"scene", scene.name},
                          {"summary", scene.summary},
                          {"triangles", scene.triangles},
                          {"instances", scene.instances},
                          {"backends", contenders}});
    }
    return Json{{"software", results.software}, {"threads", results.threads}, {"width", results.width},
                {"height", results.height},     {"spp", results.spp},         {"rays", results.rays},
                {"repeat", results.repeat},     {"seconds", results.seconds}, {"scenes", scenes}}
        .dump(2);
}

}  // namespace tessera::tools::bench
