#include "master/filter/none.h"

#include <algorithm>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

class None final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values&, Output& out, RunContext context) override {
        Report report;
        report.stopped = context.stop.stop_requested();
        if (report.stopped) return report;
        PassTimer timer(report, "copy", 8.0 * inputs.color_components());
        shape(out.picture, inputs, inputs.color_components());
        for (std::uint32_t c = 0; c < inputs.color_components(); ++c) {
            std::ranges::copy(inputs.color(c), out.picture.plane(c).begin());
        }
        return report;
    }
};

}  // namespace

FilterEntry none_entry() {
    return {{.name = "none",
             .summary = "no denoising: the mean of the samples",
             .source = "",
             .channels = [](const Values&) { return frame::ChannelSet{frame::Channel::Radiance}; },
             .consistent = true},
            [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<None>(); }};
}

}  // namespace tessera::filter
