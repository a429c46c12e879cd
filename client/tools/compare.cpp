#include "client/tools/compare.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "mediator/picture/exr_reader.h"
#include "mediator/picture/flip.h"
#include "mediator/picture/metrics.h"

namespace tessera::tools {

namespace {

constexpr const char* CompareName = "compare";

struct Value {
    const char* name;
    double value;
    const char* meaning;
};
using Values = std::vector<Value>;

Values values_of(const frame::Image& picture, const frame::Image& reference) {
    Values values{{"mse", picture::mse(picture, reference), "mean squared difference"},
                  {"relmse", picture::relmse(picture, reference), "relative to the reference"},
                  {"psnr", picture::psnr(picture, reference), "dB, tone-mapped"},
                  {"ssim", picture::ssim(picture, reference), "tone-mapped, 1 = equal"}};
    if (picture.components == 1 || picture.components == 3) {
        values.push_back({"flip_mean", picture::ldr_flip_mean(picture, reference), "LDR-FLIP of [0, 1]"});
        values.push_back({"hdr_flip_mean", picture::hdr_flip_mean(picture, reference), "HDR-FLIP"});
    }
    return values;
}

// JSON has no infinities: those become the largest number, NaN becomes null.
double writable(double value) {
    constexpr double Largest = std::numeric_limits<double>::max();
    return std::clamp(value, -Largest, Largest);
}

void print_json(const CompareOptions& options, const Values& values, bool within, std::ostream& out) {
    nlohmann::ordered_json object{
        {"picture", options.picture}, {"reference", options.reference}, {"layer", options.layer}};
    for (const Value& value : values) object[value.name] = writable(value.value);
    if (options.max_relmse) {
        object["max_relmse"] = *options.max_relmse;
        object["within"] = within;
    }
    out << object.dump(2) << "\n";
}

void print_table(const CompareOptions& options, const Values& values, bool within, std::ostream& out) {
    for (const Value& value : values) {
        out << std::left << std::setw(14) << value.name << " " << std::setw(12) << std::setprecision(6)
            << value.value << " " << value.meaning << "\n";
    }
    if (options.max_relmse) {
        out << "relmse is " << (within ? "within " : "not within ") << *options.max_relmse << "\n";
    }
}

}  // namespace

int run_compare(const CompareOptions& options, std::ostream& out) {
    const picture::Picture picture = picture::read_exr(options.picture, options.layer);
    const picture::Picture reference = picture::read_exr(options.reference, options.layer);
    if (picture.window != reference.window) {
        const auto text = [](const Rect& r) {
            return std::to_string(r.x) + "," + std::to_string(r.y) + "," + std::to_string(r.width) + "," +
                   std::to_string(r.height);
        };
        throw Error(ErrorCode::InvalidInput, "'" + options.picture + "' covers " + text(picture.window) +
                                                 " and '" + options.reference + "' covers " +
                                                 text(reference.window) +
                                                 ": the pictures must have the same size and crop window");
    }
    const Values values = values_of(picture.image, reference.image);
    const auto relmse = std::find_if(values.begin(), values.end(), [](const Value& value) {
        return std::string_view(value.name) == "relmse";
    });
    const bool within = !options.max_relmse || relmse->value <= *options.max_relmse;  // NaN is not within
    (options.json ? print_json : print_table)(options, values, within, out);
    return within ? 0 : ExitComparison;
}

Command compare_command(cli::CommandLine& program) {
    const auto options = std::make_shared<CompareOptions>();
    cli::CommandLine& line =
        program.command(CompareName, "Compare a picture with a reference: mse, relMSE, PSNR, SSIM, FLIP.");
    line.positional("picture", "OpenEXR file", options->picture);
    line.positional("reference", "OpenEXR file of the same size", options->reference);
    line.option("--layer", "layer to compare, as albedo or raw (default: R G B)", options->layer);
    line.flag("--json", "print one JSON object", options->json);
    line.option("--max-relmse", "exit with 1 if relmse is larger", options->max_relmse);
    line.examples({"tessera compare out.exr reference.exr",
                   "tessera compare out.exr reference.exr --layer high_variance --max-relmse 0.01"});
    return {CompareName, [options](std::string_view) {
                try {
                    return run_compare(*options, std::cout);
                } catch (const Error& error) {
                    return report_error(CompareName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
