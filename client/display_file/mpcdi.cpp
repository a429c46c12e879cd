#include "client/display_file/mpcdi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <set>
#include <string_view>

#include "client/display_file/file_bytes.h"
#include "client/display_file/mpcdi_xml.h"
#include "client/display_file/pfm.h"
#include "client/display_file/zip_archive.h"

namespace tessera::display_file {

namespace {

constexpr std::size_t MostText = std::size_t{16} << 20;
constexpr std::size_t MostRegions = 64;
constexpr float NoPoint = std::numeric_limits<float>::quiet_NaN();

class Reader {
  public:
    // Without an archive: only the text.
    Reader(const ZipArchive* archive, std::span<const std::byte> text, const std::string& name)
        : archive_(archive), xml_(text, name) {}

    Mpcdi read() {
        mpcdi_.profile = profile();
        const pugi::xml_node display = xml_.child(xml_.root(), "display");
        if (!display) xml_.refuse(xml_.root(), "has no <display>");
        for (const pugi::xml_node buffer : xml_.all(display, "buffer"))
            for (const pugi::xml_node region : xml_.all(buffer, "region")) read_region(buffer, region);
        if (mpcdi_.regions.empty()) xml_.refuse(display, "has no regions");
        if (mpcdi_.regions.size() > MostRegions)
            xml_.refuse(display, "has more than " + std::to_string(MostRegions) + " regions");
        for (const pugi::xml_node fileset : xml_.all(xml_.root(), "fileset")) read_files(fileset);
        for (std::size_t i = 0; i < mpcdi_.regions.size(); ++i) check(mpcdi_.regions[i], nodes_[i]);
        return std::move(mpcdi_);
    }

  private:
    MpcdiProfile profile() const {
        const std::string word = xml_.required(xml_.root(), "profile");
        if (word == "2d") return MpcdiProfile::Flat;
        if (word == "3d") return MpcdiProfile::FixedEye;
        if (word == "a3" || word == "a3d") return MpcdiProfile::MovingEye;
        if (word == "sl") return MpcdiProfile::ShaderLamps;
        xml_.refuse(xml_.root(), "the profile '" + word + "' is not one of 2d, 3d, a3, sl");
    }

    void read_region(pugi::xml_node buffer, pugi::xml_node node) {
        MpcdiRegion region;
        region.id = xml_.required(node, "id");
        region.buffer = xml_.text(buffer, "id");
        region.width = xml_.pixels(node, "xResolution");
        region.height = xml_.pixels(node, "yResolution");
        if (!xml_.text(buffer, "xResolution").empty()) {
            region.buffer_width = xml_.pixels(buffer, "xResolution");
            region.buffer_height = xml_.pixels(buffer, "yResolution");
        }
        region.x = xml_.number(node, "x", 0.0);
        region.y = xml_.number(node, "y", 0.0);
        region.across = xml_.number(node, "xsize", 1.0);
        region.down = xml_.number(node, "ysize", 1.0);
        if (!(region.across > 0.0 && region.down > 0.0))
            xml_.refuse(node,
                        "region '" + region.id + "' has no size: xsize and ysize must be greater than 0");
        if (const pugi::xml_node frustum = xml_.child(node, "frustum"))
            region.frustum = read_frustum(frustum);
        if (const pugi::xml_node frame = xml_.child(node, "coordinateFrame"))
            region.frame = read_frame(frame);
        if (!ids_.insert(region.id).second) xml_.refuse(node, "two regions are called '" + region.id + "'");
        mpcdi_.regions.push_back(std::move(region));
        nodes_.push_back(node);
    }

    MpcdiFrustum read_frustum(pugi::xml_node node) const {
        const auto radians = [&](const char* name) {
            return xml_.number_in(node, name) * std::numbers::pi / 180.0;
        };
        const MpcdiFrustum frustum{.yaw = radians("yaw"),
                                   .pitch = radians("pitch"),
                                   .roll = radians("roll"),
                                   .left = radians("leftAngle"),
                                   .right = radians("rightAngle"),
                                   .down = radians("downAngle"),
                                   .up = radians("upAngle")};
        constexpr double Widest = 89.0 * std::numbers::pi / 180.0;
        if (!(frustum.left < frustum.right && frustum.down < frustum.up && frustum.left >= -Widest &&
              frustum.right <= Widest && frustum.down >= -Widest && frustum.up <= Widest))
            xml_.refuse(node,
                        "the frustum is empty or wider than 89 degrees to a side: leftAngle must be less "
                        "than rightAngle, downAngle than upAngle");
        return frustum;
    }

    glm::dvec3 read_axis(pugi::xml_node node, const char* name) const {
        const std::string word(name);
        const glm::dvec3 axis(xml_.number_in(node, (word + "x").c_str()),
                              xml_.number_in(node, (word + "y").c_str()),
                              xml_.number_in(node, (word + "z").c_str()));
        if (word == "pos") return axis;
        if (std::abs(glm::length(axis) - 1.0) > 1e-3)
            xml_.refuse(node, "the " + word + " axis is not of length 1");
        return glm::normalize(axis);
    }

    // The axes of an aeroplane: it rolls about forward, pitches about right, and yaws about down.
    MpcdiFrame read_frame(pugi::xml_node node) const {
        const MpcdiFrame frame{.position = read_axis(node, "pos"),
                               .right = read_axis(node, "pitch"),
                               .up = -read_axis(node, "yaw"),
                               .forward = read_axis(node, "roll")};
        if (glm::length(glm::cross(frame.right, frame.up) + frame.forward) > 1e-2)
            xml_.refuse(node,
                        "the axes of yaw, pitch and roll are not a right-handed system at right angles");
        return frame;
    }

    // The region that a set of files belongs to: by its name, or the enclosing one.
    MpcdiRegion& region_of(pugi::xml_node fileset) {
        std::string id = xml_.text(fileset, "region");
        if (id.empty()) id = xml_.text(fileset.parent(), "id");
        const auto found = std::ranges::find(mpcdi_.regions, id, &MpcdiRegion::id);
        if (found == mpcdi_.regions.end())
            xml_.refuse(fileset, "names files for region '" + id + "', which does not exist");
        return *found;
    }

    std::optional<std::vector<std::byte>> file(pugi::xml_node of) const {
        const std::string path = xml_.text_in(of, "path");
        if (path.empty()) return std::nullopt;
        if (archive_ == nullptr)
            xml_.refuse(of,
                        "names '" + path + "', but is not in an archive: import the archive that has both");
        const auto bytes = archive_->read(path);
        if (!bytes) xml_.refuse(of, bytes.error().what());
        return *bytes;
    }

    LoadedGrid taken(pugi::xml_node of, Expected<LoadedGrid> grid) const {
        if (!grid) xml_.refuse(of, grid.error().what());
        return std::move(*grid);
    }

    LoadedGrid light(pugi::xml_node of) const {
        const auto bytes = file(of);
        if (!bytes) return {};
        const double gamma = xml_.number_in(of, "gammaEmbedded", 1.0);
        if (!(gamma > 0.0 && gamma <= 10.0))
            xml_.refuse(of, "<gammaEmbedded> must be greater than 0 and at most 10");
        return taken(of, parse_weights(*bytes, xml_.text_in(of, "path"), gamma));
    }

    double metres(pugi::xml_node warp) const {
        const std::string unit = xml_.text_in(warp, "geometricUnit");
        constexpr std::array<std::pair<std::string_view, double>, 8> Units{{{"mm", 1e-3},
                                                                            {"cm", 1e-2},
                                                                            {"dm", 0.1},
                                                                            {"m", 1.0},
                                                                            {"in", 0.0254},
                                                                            {"ft", 0.3048},
                                                                            {"yd", 0.9144},
                                                                            {"unknown", 1.0}}};
        for (const auto& [word, length] : Units)
            if (unit == word) return length;
        if (unit.empty() || unit == "unkown") return 1.0;  // misspelled by some tools
        xml_.refuse(warp, "the geometricUnit '" + unit + "' is not one of mm, cm, dm, m, in, ft, yd");
    }

    void read_warp(pugi::xml_node of, MpcdiRegion& region) {
        const auto bytes = file(of);
        if (!bytes) return;
        region.warp = taken(of, parse_pfm(*bytes, xml_.text_in(of, "path")));
        if (region.warp.components != 3)
            xml_.refuse(of, "'" + xml_.text_in(of, "path") + "' has one component; a warp has three (PF)");
        if (mpcdi_.profile == MpcdiProfile::Flat || mpcdi_.profile == MpcdiProfile::FixedEye) return;
        const double unit = metres(of);
        for (std::size_t i = 0; i < region.warp.values.size(); i += 3) {
            float* point = region.warp.values.data() + i;
            // Tools write 0, 0, 0 for pixels that are not visible.
            const bool is_nowhere = point[0] == 0.0f && point[1] == 0.0f && point[2] == 0.0f;
            for (int axis = 0; axis < 3; ++axis)
                point[axis] = is_nowhere ? NoPoint : static_cast<float>(unit * double{point[axis]});
        }
        const std::string origin = xml_.text_in(of, "originOf3DData");
        if (origin == "centerOfMass" || origin == "floorCenter")
            mpcdi_.notices.push_back("region '" + region.id + "': points are measured from the " + origin +
                                     "; set [head] position relative to it");
    }

    void read_files(pugi::xml_node fileset) {
        MpcdiRegion& region = region_of(fileset);
        if (const auto node = xml_.child(fileset, "geometryWarpFile")) read_warp(node, region);
        if (const auto node = xml_.child(fileset, "alphaMap")) region.weights = light(node);
        if (const auto node = xml_.child(fileset, "betaMap")) region.lift = light(node);
        if (const auto node = xml_.child(fileset, "distortionMap");
            node && !xml_.text_in(node, "path").empty())
            mpcdi_.notices.push_back("region '" + region.id + "': its lens distortion is ignored");
    }

    // Each profile requires certain elements.
    void check(const MpcdiRegion& region, pugi::xml_node at) const {
        const std::string name = "region '" + region.id + "' ";
        const bool has_warp = !region.warp.values.empty();
        if (mpcdi_.profile == MpcdiProfile::FixedEye && !region.frustum)
            xml_.refuse(at, name + "needs a <frustum>: the profile is 3d");
        if (mpcdi_.profile == MpcdiProfile::MovingEye && !has_warp)
            xml_.refuse(at, name + "needs a <geometryWarpFile>: the profile is a3");
        if (mpcdi_.profile == MpcdiProfile::ShaderLamps && !has_warp && !(region.frustum && region.frame))
            xml_.refuse(at, name + "needs a <frustum> and a <coordinateFrame>: the profile is sl");
    }

    const ZipArchive* archive_;
    MpcdiXml xml_;
    Mpcdi mpcdi_;
    std::vector<pugi::xml_node> nodes_;  // of the regions in the text
    std::set<std::string> ids_;
};

}  // namespace

Expected<Mpcdi> parse_mpcdi(std::span<const std::byte> bytes, const std::string& name) {
    const auto read = [&](const ZipArchive* archive, std::span<const std::byte> text) -> Expected<Mpcdi> {
        if (text.size() > MostText)
            return failure(ErrorCode::InvalidInput, name + ": mpcdi.xml has more than 16 MiB");
        try {
            return Reader(archive, text, name).read();
        } catch (const Error& error) {
            return tl::unexpected(error);
        }
    };
    if (!bytes.empty() && bytes[0] == std::byte{'<'}) return read(nullptr, bytes);
    const auto archive = ZipArchive::open(bytes, name);
    if (!archive) return tl::unexpected(archive.error());
    const auto text = archive->read("mpcdi.xml");
    if (!text) return tl::unexpected(text.error());
    return read(&*archive, *text);
}

Expected<Mpcdi> load_mpcdi(const std::string& path) {
    const auto bytes = read_file(path, MostCalibrationBytes);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_mpcdi(*bytes, path);
}

}  // namespace tessera::display_file
