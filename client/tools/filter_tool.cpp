#include "client/tools/filter_tool.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/tools/display_transform_options.h"
#include "client/tools/pictures.h"
#include "client/tools/view_attributes.h"
#include "master/filter/catalog.h"
#include "master/render/reconstruction.h"
#include "mediator/base/old_names.h"

namespace tessera::tools {

namespace {

using Json = nlohmann::ordered_json;

std::string channels_text(frame::ChannelSet channels) {
    std::string text;
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (channels.contains(entry.channel)) text += (text.empty() ? "" : ", ") + std::string(entry.name);
    }
    return text;
}

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

std::string standard_text(const filter::Parameter& parameter) {
    return parameter.choices.empty()
               ? number(parameter.default_value)
               : std::string(parameter.choices[static_cast<std::size_t>(parameter.default_value)]);
}

std::string range_text(const filter::Parameter& parameter) {
    if (parameter.choices.empty()) return number(parameter.minimum) + " to " + number(parameter.maximum);
    std::string text;
    for (const std::string_view choice : parameter.choices)
        text += (text.empty() ? "" : "|") + std::string(choice);
    return text;
}

void print_table(const filter::FilterEntry& entry) {
    const filter::Description& filter = entry.description;
    std::cout << filter.name << "  " << filter.summary << (filter.source.empty() ? "" : " (") << filter.source
              << (filter.source.empty() ? "" : ")") << "\n    "
              << (filter.consistent ? "consistent: its error converges to 0 with the samples" : "biased")
              << (filter.temporal ? "; temporal: keeps a history" : "")
              << (filter.reproducible ? "" : "; not for --reproducible") << "\n    reads "
              << channels_text(filter.channels(filter::default_values(filter))) << "\n";
    if (entry.why_unavailable != nullptr) {
        const std::string why = entry.why_unavailable();
        std::cout << "    " << (why.empty() ? "available on this machine" : "unavailable: " + why) << "\n";
    }
    for (const filter::Parameter& parameter : filter.parameters) {
        std::string head = "    " + std::string(parameter.name) + "=" + standard_text(parameter);
        if (!parameter.unit.empty()) head += " " + std::string(parameter.unit);
        head.resize(std::max<std::size_t>(head.size() + 2, 30), ' ');
        std::cout << head << parameter.meaning << " (" << range_text(parameter) << ")\n";
    }
}

// The film channels (AOVs) that filters read; EXR files store them as layers.
void print_channels() {
    std::cout << "\nchannels\n";
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        std::string head = "    " + std::string(entry.name);
        head.resize(std::max<std::size_t>(head.size() + 2, 20), ' ');
        std::cout << head << entry.meaning << "\n";
    }
}

Json as_json(const filter::FilterEntry& filter_entry) {
    const filter::Description& filter = filter_entry.description;
    const std::string why_unavailable = filter::why_unavailable(filter_entry);
    Json parameters = Json::array();
    for (const filter::Parameter& parameter : filter.parameters) {
        Json entry{{"name", parameter.name}, {"unit", parameter.unit}, {"meaning", parameter.meaning}};
        if (parameter.choices.empty()) {
            entry.update({{"default", parameter.default_value},
                          {"minimum", parameter.minimum},
                          {"maximum", parameter.maximum},
                          {std::string(*old_name("key", "minimum")), parameter.minimum},
                          {std::string(*old_name("key", "maximum")), parameter.maximum}});
        } else {
            entry.update({{"default", standard_text(parameter)}, {"choices", parameter.choices}});
        }
        parameters.push_back(std::move(entry));
    }
    return {{"name", filter.name},
            {"summary", filter.summary},
            {"source", filter.source},
            {"consistent", filter.consistent},
            {"temporal", filter.temporal},
            {"reproducible", filter.reproducible},
            {"available", why_unavailable.empty()},
            {"why_unavailable", why_unavailable},
            {"path_class", name(filter.path_class)},
            {"channels", channels_text(filter.channels(filter::default_values(filter)))},
            {"parameters", parameters}};
}

struct FilterOptions {
    std::string input, output, filter;
    DisplayTransformOptions display;
    bool json = false, maps = false;
};

// InvalidInput if the film lacks channels that the filter needs, or has another path class.
Expected<void> check(const filter::Choice& choice, const picture::FilmFile& file, const view::View& view) {
    const filter::Description& filter = choice.entry->description;
    const auto missing = filter::missing_channels(choice, file.film.channels);
    if (!missing.empty()) {
        using enum frame::Channel;
        const bool is_old = missing.contains(FirstHalf) && file.film.channels.contains(HalfBufferA);
        return failure(ErrorCode::InvalidInput,
                       "filter '" + std::string(filter.name) + "' needs " + channels_text(missing) +
                           ", which the film does not contain" +
                           (is_old ? " (its half_buffer_a has halves that depend on each other)" : "") +
                           (missing == frame::ChannelSet{Root} ? " (transform=none does without it)" : "") +
                           ": render it with --save-statistics");
    }
    if (filter.path_class != view::PathClass::Indirect && filter.path_class != view.path_class) {
        return failure(ErrorCode::InvalidInput,
                       "filter '" + std::string(filter.name) + "' works on the path class " +
                           name(filter.path_class) + ", but the film has " + name(view.path_class) +
                           ": render it with --path-class " + name(filter.path_class));
    }
    return {};
}

void write(const FilterOptions& options, const DisplayChoice& display, const picture::FilmFile& file,
           const filter::Output& output) {
    const frame::Image picture = interleaved(output.picture);
    if (picture_format(options.output) == PictureFormat::Exr) {
        std::vector<picture::Layer> maps;
        for (const filter::DebugMap& map : output.maps) {
            static const std::vector<std::string> Names{"R", "G", "B", "A"};
            const std::uint32_t components = map.planes.components();
            maps.push_back({map.name,
                            components == 1
                                ? std::vector<std::string>{"Y"}
                                : std::vector<std::string>(Names.begin(), Names.begin() + components),
                            interleaved(map.planes)});
        }
        picture::write_film_exr(options.output, file, picture, picture::Statistics::Omit, maps);
    } else {
        write_picture(options.output, picture, display.transform, display.custom_view());
    }
}

int run_filter(const FilterOptions& options) {
    const auto wrong = [](std::string_view text) { return report_error("filter", cli::ExitUsage, text); };
    const auto choice = filter::parse_choice(options.filter, filter::catalog());
    if (!choice) return wrong(std::string("--filter: ") + choice.error().what() + "; see tessera filters");
    for (const std::string& hint : choice->hints) std::cerr << "tessera: " << hint << "\n";
    if (const std::string why = filter::why_unavailable(*choice->entry); !why.empty())
        return report_error("filter", cli::ExitUnavailable, why);
    if (!picture_format(options.output)) return wrong("-o: the file name must end in .exr, .png or .jpg");
    const auto display = parse_options(options.display);
    if (!display) return wrong(display.error().what());
    if (const auto unused = unused_display_options(options.display, {options.output}))
        std::cerr << "tessera filter: " << *unused << "\n";
    picture::FilmFile file = picture::read_film_exr(options.input);
    const auto view = view_from_attributes(file.attributes);
    if (!view)
        return report_error("filter", ExitBadInput, "film '" + options.input + "': " + view.error().what());
    if (auto fine = check(*choice, file, *view); !fine)
        return report_error("filter", ExitBadInput, fine.error().what());
    file.attributes["tessera.filter"] = filter::to_text(*choice);

    const filter::Inputs inputs = filter::make_inputs(file.film, *view);
    const auto filter = choice->entry->make(inputs.width, inputs.height);
    filter::Output output{.wants_maps = options.maps};
    tbb::task_arena arena;
    const auto started = std::chrono::steady_clock::now();
    const filter::Report report = filter->run(inputs, choice->values, output, {arena, {}});
    const double total = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    write(options, *display, file, output);

    if (options.json) {
        Json passes = Json::array();
        for (const filter::Pass& pass : report.passes) {
            passes.push_back({{"name", pass.name},
                              {"seconds", seconds(pass.time)},
                              {"bytes_per_pixel", pass.bytes_per_pixel}});
        }
        std::cout << Json{{"filter", filter::to_text(*choice)},
                          {"width", inputs.width},
                          {"height", inputs.height},
                          {"seconds", total},
                          {"passes", passes},
                          {"notes", std::vector<std::string>(report.notes.begin(), report.notes.end())}}
                         .dump(2)
                  << "\n";
        return 0;
    }
    char line[160];
    std::snprintf(line, sizeof line, "%s: %ux%u pixels in %.1f ms\n", filter::to_text(*choice).c_str(),
                  inputs.width, inputs.height, total * 1e3);
    std::cout << line;
    for (const std::string_view note : report.notes) std::cout << note << "\n";
    std::cout << "wrote " << options.output << "\n";
    return 0;
}

}  // namespace

Command filter_command(cli::CommandLine& program) {
    const auto options = std::make_shared<FilterOptions>();
    cli::CommandLine& line =
        program.command("filter", "Apply a reconstruction filter to a saved film, without rendering again.");
    line.positional("FILM", "EXR file written with --save-statistics", options->input);
    line.option("-o,--output", "picture to write, .exr, .png or .jpg", options->output);
    line.required("--output");
    line.option("--filter", "NAME[:key=value,...]; tessera filters lists them", options->filter);
    line.required("--filter");
    options->display.add_to(line);
    line.flag("--maps", "write the filter's debug maps as layers of the EXR", options->maps);
    line.flag("--json", "print one JSON object with all measurements", options->json);
    line.examples({"tessera render room.glb -o film.exr --spp 4 --save-statistics",
                   "tessera filter film.exr -o smooth.png --filter fdf",
                   "tessera filter film.exr -o pixel.exr --filter pixel:t=0.002 --maps"});
    return {"filter", [options](std::string_view) {
                try {
                    return run_filter(*options);
                } catch (const Error& error) {
                    return report_error("filter", exit_code(error.code()), error.what());
                }
            }};
}

Command filters_command(cli::CommandLine& program) {
    const auto json = std::make_shared<bool>(false);
    cli::CommandLine& line = program.command(
        "filters", "List the reconstruction filters (denoisers) with their inputs and parameters.");
    line.flag("--json", "print one JSON array", *json);
    line.examples({"tessera filters", "tessera filters --json"});
    return {"filters", [json](std::string_view) {
                Json all = Json::array();
                for (const filter::FilterEntry& entry : filter::catalog()) {
                    if (*json) {
                        all.push_back(as_json(entry));
                    } else {
                        print_table(entry);
                    }
                }
                *json ? void(std::cout << all.dump(2) << "\n") : print_channels();
                return 0;
            }};
}

}  // namespace tessera::tools
