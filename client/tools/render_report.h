#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mediator/session/view_summary.h"

namespace tessera::tools {

struct RenderReport {
    const session::ViewRequest& request;
    const session::ViewSummary& summary;
    double seconds_total = 0;
    std::string film_hash;
    std::optional<std::uint32_t> frame;  // of a sequence
};

double samples_per_pixel(const session::ViewRequest& request, const session::ViewSummary& summary);

// The one object of --json, of a frame on one line, and the few lines for a person, of a frame but one.
std::string as_json(const RenderReport& report);
std::string as_text(const RenderReport& report, const std::vector<std::string>& outputs);

}  // namespace tessera::tools
