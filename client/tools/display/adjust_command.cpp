#include "client/tools/display/adjust_command.h"

#include <iostream>
#include <memory>
#include <optional>

#include "client/tools/cluster_options.h"
#include "client/tools/display/live_display.h"
#include "client/tools/values.h"

namespace tessera::tools {

namespace {

constexpr const char* AdjustName = "display adjust";

struct AdjustOptions {
    client::Address address;
    std::optional<double> eye_separation, zero_parallax, exposure;
    std::string pattern;
    std::optional<std::string> layers;
};

// "0,2"
Expected<std::uint32_t> parse_output_layers(const std::string& text) {
    std::uint32_t layers = 0;
    for (const std::string& word : split_list(text)) {
        if (word.size() != 1 || word[0] < '0' || word[0] >= char('0' + display::MaxLayers))
            return failure(ErrorCode::InvalidInput,
                           "--layers: '" + word + "' is not a layer: give numbers from 0 to 3, as 0,2");
        layers |= 1u << (word[0] - '0');
    }
    if (layers == 0) return failure(ErrorCode::InvalidInput, "--layers: give numbers from 0 to 3, as 0,2");
    return layers;
}

int run(const AdjustOptions& options) {
    session::DisplayAdjustment change{.eye_separation = options.eye_separation,
                                      .zero_parallax = options.zero_parallax,
                                      .exposure = options.exposure,
                                      .pattern = {},
                                      .shown_layers = {}};
    if (!options.pattern.empty()) change.pattern = options.pattern == "on";
    if (options.layers) {
        const auto layers = parse_output_layers(*options.layers);
        if (!layers) return report_error(AdjustName, cli::ExitUsage, layers.error().what());
        change.shown_layers = *layers;
    }
    if (!change.eye_separation && !change.zero_parallax && !change.exposure && !change.pattern &&
        !change.shown_layers)
        return report_error(AdjustName, cli::ExitUsage,
                            "nothing to adjust: give one of its options, as --exposure 1");
    const SteadyClock clock;
    const DisplayMember member = join_display(options.address, "tessera display adjust", clock);
    member.session->adjust_display(change);
    std::cout << "display '" << member.display << "' is adjusted\n";
    return 0;
}

}  // namespace

Command adjust_display_command(cli::CommandLine& display) {
    const auto options = std::make_shared<AdjustOptions>();
    cli::CommandLine& line =
        display.command("adjust", "Change settings of the open display, on all outputs at once.");
    add_cluster_options(line, options->address);
    line.required("--master");
    line.option("--eye-separation", "metres between the eyes", options->eye_separation);
    line.option("--zero-parallax", "distance of zero parallax from the head, in metres; 0 = on the screens",
                options->zero_parallax);
    line.option("--exposure", "exposure in EV: +1 doubles the brightness", options->exposure);
    line.choice("--pattern", "show the test pattern instead of the scene", options->pattern, {"on", "off"});
    line.option("--layers", "layers to show, as 0,2: indices in the order of the display file, from 0",
                options->layers);
    line.examples(
        {"tessera display adjust --eye-separation 0.06 --zero-parallax 2.5 --master "
         "tcp://render-1:7420 --keys ~/.tessera",
         "tessera display adjust --pattern on --master tcp://127.0.0.1:7420"});
    return {AdjustName, [options](std::string_view) {
                try {
                    return run(*options);
                } catch (const Error& error) {
                    return report_error(AdjustName, exit_code(error.code()), error.what());
                }
            }};
}

}  // namespace tessera::tools
