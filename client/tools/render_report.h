#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mediator/picture/custom_view.h"
#include "mediator/session/view_summary.h"

namespace tessera::tools {

struct RenderReport {
    const session::ViewRequest& request;
    const session::ViewSummary& summary;
    double seconds_total = 0;
    std::string film_hash;
    std::optional<std::uint32_t> frame;  // of a sequence
    const picture::CustomView* custom_view = nullptr;
};

double samples_per_pixel(const session::ViewRequest& request, const session::ViewSummary& summary);

// The JSON object of --json (on one line for frames of a sequence), and the text summary (one line for such frames).
std::string as_json(const RenderReport& report);
std::string as_text(const RenderReport& report, const std::vector<std::string>& outputs);

}  // namespace tessera::tools
