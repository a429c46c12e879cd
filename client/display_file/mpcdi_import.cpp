#include "client/display_file/mpcdi_import.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <set>

namespace tessera::display_file {

namespace {

constexpr double ScreenWidth = 2.0, ScreenDistance = 2.0;  // metres, of screens without measurements

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
}

std::string list(const glm::dvec3& v) {
    return "[" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "]";
}

// A name that display files accept: docs/displays.md.
std::string plain_name(const std::string& id, std::set<std::string>& used) {
    std::string name = id.substr(0, 48);
    for (char& c : name)
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '-';
    while (!name.empty() && name.front() == '-') name.erase(0, 1);
    if (name.empty()) name = "output";
    std::string unique = name;
    for (int count = 2; !used.insert(unique).second; ++count) unique = name + "-" + std::to_string(count);
    return unique;
}

std::vector<std::byte> as_pfm(const LoadedGrid& grid) {
    const std::string header = std::string(grid.components == 3 ? "PF" : "Pf") + "\n" +
                               std::to_string(grid.columns) + " " + std::to_string(grid.rows) + "\n-1.0\n";
    std::vector<std::byte> bytes(header.size() + 4 * grid.values.size());
    std::memcpy(bytes.data(), header.data(), header.size());
    std::memcpy(bytes.data() + header.size(), grid.values.data(), 4 * grid.values.size());
    return bytes;
}

// The orientation of a frustum, as axes in display space: right, up, back.
glm::dmat3 axes_of(const MpcdiFrustum& frustum) {
    glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), -frustum.yaw, glm::dvec3(0, 1, 0));
    turn = glm::rotate(turn, frustum.pitch, glm::dvec3(1, 0, 0));
    return glm::dmat3(glm::rotate(turn, -frustum.roll, glm::dvec3(0, 0, 1)));
}

glm::dvec3 in_display(const MpcdiRegion& region, const glm::dvec3& point) {
    if (!region.frame) return point;
    return {glm::dot(point, region.frame->right), glm::dot(point, region.frame->up),
            -glm::dot(point, region.frame->forward)};
}

// The region's warp, or the identity: two nodes a side are extrapolated to its edges.
LoadedGrid uv_grid(const MpcdiRegion& region) {
    if (!region.warp.values.empty()) return region.warp;
    return {2, 2, 3, {0.25f, 0.25f, 0, 0.75f, 0.25f, 0, 0.25f, 0.75f, 0, 0.75f, 0.75f, 0}};
}

template <class Map>
LoadedGrid mapped(LoadedGrid grid, const Map& map) {
    for (std::size_t i = 0; i < grid.values.size(); i += 3) {
        const glm::dvec3 to = map(glm::dvec3(grid.values[i], grid.values[i + 1], grid.values[i + 2]));
        for (int c = 0; c < 3; ++c) grid.values[i + std::size_t(c)] = static_cast<float>(to[c]);
    }
    return grid;
}

class Importer {
  public:
    Importer(const Mpcdi& mpcdi, const std::string& stem) : mpcdi_(mpcdi), stem_(stem) {}

    ImportedDisplay import() {
        result_.notices = mpcdi_.notices;
        for (const MpcdiRegion& region : mpcdi_.regions) add(region);
        result_.text =
            "# Lengths are in metres; replace the screens marked 'to be measured' by measured ones.\n" +
            screens_ + outputs_;
        return std::move(result_);
    }

  private:
    void add(const MpcdiRegion& region) {
        name_ = plain_name(region.id, names_);
        outputs_ += "\n[[output]]\nname = \"" + name_ + "\"\nsize = [" + std::to_string(region.width) + ", " +
                    std::to_string(region.height) + "]\n";
        const bool has_points = !region.warp.values.empty();
        if (mpcdi_.profile == MpcdiProfile::Flat) {
            add_flat(region);
        } else if (mpcdi_.profile == MpcdiProfile::FixedEye) {
            add_fixed(region);
        } else if (has_points) {
            const bool is_lamp = mpcdi_.profile == MpcdiProfile::ShaderLamps;
            put("points",
                is_lamp ? mapped(region.warp, [&](const glm::dvec3& p) { return in_display(region, p); })
                        : region.warp);
        } else {
            add_projector(region);
        }
        if (!region.weights.values.empty()) put("weights", region.weights);
        if (!region.lift.values.empty()) put("lift", region.lift);
    }

    void put(const std::string& key, const LoadedGrid& grid) {
        const std::string file = stem_ + "-" + name_ + "-" + key + ".pfm";
        outputs_ += key + " = \"" + file + "\"\n";
        result_.files.push_back({file, as_pfm(grid)});
    }

    // Defines a screen on first use: two metres wide, two metres away.
    void use_screen(const std::string& name, double aspect) {
        outputs_ += "screen = \"" + name + "\"\n";
        if (!screens_made_.insert(name).second) return;
        const double right = ScreenWidth / 2, top = right / aspect;
        screens_ += "\n[[screen]]  # to be measured\nname = \"" + name +
                    "\"\nlower_left = " + list({-right, -top, -ScreenDistance}) +
                    "\nlower_right = " + list({right, -top, -ScreenDistance}) +
                    "\nupper_left = " + list({-right, top, -ScreenDistance}) + "\n";
        result_.notices.push_back("screen '" + name + "' is a guess: measure its corners");
    }

    void add_flat(const MpcdiRegion& region) {
        std::set<std::string> unused;
        const double aspect = region.buffer_width > 0
                                  ? double(region.buffer_width) / region.buffer_height
                                  : region.width / region.across / (region.height / region.down);
        use_screen("screen-" + plain_name(region.buffer, unused), aspect);
        put("warp", mapped(uv_grid(region), [&](const glm::dvec3& uv) {
                return glm::dvec3(region.x + uv.x * region.across, region.y + uv.y * region.down, 0.0);
            }));
    }

    void add_fixed(const MpcdiRegion& region) {
        const MpcdiFrustum& frustum = *region.frustum;
        const glm::dmat3 axes = axes_of(frustum);
        const double left = std::tan(frustum.left), right = std::tan(frustum.right),
                     down = std::tan(frustum.down), up = std::tan(frustum.up);
        put("points", mapped(uv_grid(region), [&](const glm::dvec3& uv) {
                const glm::dvec3 direction(left + uv.x * (right - left), up + uv.y * (down - up), -1.0);
                return ScreenDistance * (axes * direction);
            }));
    }

    void add_projector(const MpcdiRegion& region) {
        const MpcdiFrustum& frustum = *region.frustum;
        const glm::dmat3 axes = axes_of(frustum);
        const glm::dvec3 position = in_display(region, region.frame->position);
        const double left = std::tan(frustum.left), right = std::tan(frustum.right),
                     down = std::tan(frustum.down), up = std::tan(frustum.up);
        use_screen("screen", 4.0 / 3.0);
        outputs_ += "projector = { position = " + list(position) + ", look_at = " + list(position - axes[2]) +
                    ", up = " + list(axes[1]) + ", throw = " + number(1.0 / (right - left)) + ", shift = [" +
                    number((right + left) / (right - left) / 2) + ", " +
                    number((up + down) / (up - down) / 2) + "] }\n";
        const double aspect = (right - left) / (up - down);
        if (std::abs(aspect * region.height / region.width - 1.0) > 0.005)
            result_.notices.push_back("region '" + region.id +
                                      "': its pixels are not square; square ones are assumed");
    }

    const Mpcdi& mpcdi_;
    std::string stem_, name_, screens_, outputs_;
    std::set<std::string> names_, screens_made_;
    ImportedDisplay result_;
};

}  // namespace

ImportedDisplay import_mpcdi(const Mpcdi& mpcdi, const std::string& stem) {
    return Importer(mpcdi, stem).import();
}

}  // namespace tessera::display_file
