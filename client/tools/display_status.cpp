#include "client/tools/display_status.h"

#include <cstdio>
#include <string>

namespace tessera::tools {

void print_display(const session::DisplayStatus& display) {
    if (display.name.empty()) return;
    std::printf("display '%s': frame %llu of scene version %llu, %.1f Hz\n", display.name.c_str(),
                static_cast<unsigned long long>(display.frames),
                static_cast<unsigned long long>(display.version.number), display.rate);
    std::printf("  %-20s %-16s %-8s %9s %6s %8s %s\n", "output", "host", "state", "frames", "late", "samples",
                "difference of the eyes");
    for (const session::OutputStatus& output : display.outputs) {
        char difference[32] = "";
        if (output.stereo_difference > 0.0)
            std::snprintf(difference, sizeof difference, "%.4f", output.stereo_difference);
        std::printf("  %-20.20s %-16.16s %-8s %9llu %6llu %8llu %s\n", output.name.c_str(),
                    output.host.c_str(), std::string(enumerator_name(output.state)).c_str(),
                    static_cast<unsigned long long>(output.frames),
                    static_cast<unsigned long long>(output.late),
                    static_cast<unsigned long long>(output.samples), difference);
    }
}

}  // namespace tessera::tools
