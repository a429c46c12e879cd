#include "client/tools/filter_options.h"

#include <iostream>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"

namespace tessera::tools {

void FilterOption::add_to(cli::CommandLine& command) {
    command.option_with_default("--denoise",
                                std::string("denoise the picture: --denoise uses the recommended filter (") +
                                    RecommendedFilter + "); or --denoise=NAME[:key=value,...]",
                                denoise, RecommendedFilter);
    command.option("--filter", "same as --denoise=NAME[:key=value,...]; tessera filters lists the filters",
                   filter);
}

Expected<std::string> parse_options(const FilterOption& option) {
    if (option.denoise && !option.filter.empty())
        return failure(ErrorCode::InvalidInput, "--denoise and --filter mean the same: give one of them");
    const std::string& text = option.denoise ? *option.denoise : option.filter;
    if (text.empty()) return std::string();
    const auto choice = filter::parse_choice(text, filter::catalog());
    if (!choice) {
        return failure(ErrorCode::InvalidInput, std::string(option.denoise ? "--denoise: " : "--filter: ") +
                                                    choice.error().what() + "; see tessera filters");
    }
    for (const std::string& hint : choice->hints) std::cerr << "tessera: " << hint << "\n";
    return filter::to_text(*choice);
}

Expected<void> check_available(const std::string& filter) {
    const auto choice = filter::parse_choice(filter, filter::catalog());
    if (!choice) return tl::unexpected(choice.error());
    const std::string why = filter::why_unavailable(*choice->entry);
    return why.empty() ? Expected<void>() : failure(ErrorCode::Unavailable, why);
}

Expected<void> check_reproducible(const std::string& filter) {
    const auto choice = filter::parse_choice(filter, filter::catalog());
    if (!choice) return tl::unexpected(choice.error());
    const std::string why = filter::why_not_reproducible(*choice->entry);
    return why.empty() ? Expected<void>() : failure(ErrorCode::InvalidInput, "--reproducible: " + why);
}

Expected<void> check_error_estimate(const std::string& filter) {
    const auto choice = filter::parse_choice(filter, filter::catalog());
    if (!choice) return tl::unexpected(choice.error());
    const std::string why = filter::why_no_error_estimate(*choice);
    return why.empty() ? Expected<void>()
                       : failure(ErrorCode::InvalidInput,
                                 "--error: " + why + ": leave the filter to --denoise, or use --noise");
}

}  // namespace tessera::tools
