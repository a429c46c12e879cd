#include <algorithm>

#include "client/display_file/display_file.h"
#include "client/display_file/document.h"
#include "client/display_file/mesh_file.h"
#include "client/display_file/mpcdi.h"
#include "client/display_file/mpcdi_import.h"
#include "client/display_file/pfm.h"
#include "client/tools/display/head_packet.h"
#include "mediator/wire/display_codec.h"
#include "tests/fuzz/decoders/decoder.h"
#include "tests/fuzz/decoders/round_trip.h"

// Display files, the files of calibration tools, and what trackers send.
namespace tessera::fuzz {

namespace {

void require_whole(const display_file::LoadedGrid& grid) {
    require(grid.values.size() == std::size_t{grid.columns} * grid.rows * grid.components,
            "a grid lacks nodes");
}

std::vector<std::byte> pfm_of(const std::string& header, const std::vector<float>& values) {
    std::vector<std::byte> bytes = bytes_of(header);
    const auto raw = std::as_bytes(std::span(values));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
    return bytes;
}

constexpr std::string_view SampleMesh = "2\n2 2\n-1.5 -1 0 0 1\n1.5 -1 1 0 1\n-1.5 1 0 1 0.5\n1.5 1 1 1 -1\n";

// Whether a size in the file is that of a real projector: its maps take seconds to be computed.
bool has_large_size(const display_file::Value& value, bool is_size = false) {
    constexpr double LargestSize = 200.0;
    if (is_size && value.kind == display_file::Value::Kind::Number) return value.number > LargestSize;
    return std::ranges::any_of(value.list, [&](const auto& one) { return has_large_size(one, is_size); }) ||
           std::ranges::any_of(value.table, [](const display_file::TableEntry& entry) {
               return has_large_size(entry.value, entry.key == "size");
           });
}

// Next to it lie the files points.pfm, weights.pfm and warp.data.
void display(Bytes bytes) {
    static const std::string path = [] {
        file_of("points.pfm", pfm_of("PF\n2 2\n-1\n", {-1, -1, -3, 1, -1, -3, -1, 1, -3, 1, 1, -3}));
        file_of("weights.pfm", pfm_of("Pf\n2 2\n-1\n", {0, 0.5f, 0.75f, 1}));
        file_of("warp.data", bytes_of(SampleMesh));
        return file_of("wall.toml", {}).string();
    }();
    accepts([&] {
        if (has_large_size(display_file::parse_document(text_of(bytes), path))) return;
        scene::BlobStore blobs;
        const display_file::DisplayFile file = display_file::parse_display(text_of(bytes), path, blobs);
        require(file.geometry.size() == file.display.outputs.size(), "an output has no geometry");
        require_round_trip(file.display, wire::decode_display);
    });
}

// What an archive becomes is a display file next to files that are in no other folder.
void mpcdi(Bytes bytes) {
    const auto archive = display_file::parse_mpcdi(bytes, "wall.mpcdi");
    if (!archive) return require_reason(archive.error());
    for (const display_file::MpcdiRegion& region : archive->regions) {
        for (const auto* grid : {&region.warp, &region.weights, &region.lift}) require_whole(*grid);
    }
    accepts([&] {
        const display_file::ImportedDisplay imported = display_file::import_mpcdi(*archive, "wall");
        for (const auto& file : imported.files)
            require(file.name.find('/') == std::string::npos, "a file lies in another folder: " + file.name);
        display_file::parse_document(imported.text, "wall.toml");
    });
}

Seeds mpcdi_seeds() {
    return {bytes_of(
        "<?xml version=\"1.0\"?>\n<MPCDI profile=\"3d\" geometry=\"1\" color=\"1\" version=\"2.0\"><display>"
        "<buffer id=\"b\" Xresolution=\"3000\" Yresolution=\"1000\"><region id=\"left\" Xresolution=\"40\" "
        "Yresolution=\"30\" x=\"0\" y=\"0\" xsize=\"1\" ysize=\"1\"><frustum><yaw>10</yaw><pitch>2</pitch>"
        "<roll>0</roll><rightAngle>20</rightAngle><leftAngle>-20</leftAngle><upAngle>15</upAngle>"
        "<downAngle>-15</downAngle></frustum></region></buffer></display><files/></MPCDI>\n")};
}

void pfm(Bytes bytes) {
    const auto grid = display_file::parse_pfm(bytes, "map.pfm");
    if (grid) {
        require_whole(*grid);
    } else {
        require_reason(grid.error());
    }
    const auto weights = display_file::parse_weights(bytes, "map.pfm", 2.2);
    if (!weights) return require_reason(weights.error());
    require_whole(*weights);
    require(weights->components == 1, "weights have several components");
    require(std::ranges::all_of(weights->values, [](float value) { return value >= 0.0f && value <= 1.0f; }),
            "a weight is not in [0, 1]");
}

Seeds pfm_seeds() {
    return {pfm_of("PF\n2 1\n-1.0\n", {1, 2, 3, 4, 5, 6}), pfm_of("Pf 3 2 -1\n", {0, 1, 0.5f, 0, 1, 0.25f}),
            pfm_of("Pf\n1 1\n1.0\n", {0.0f})};
}

void warp_mesh(Bytes bytes) {
    const auto mesh = display_file::parse_mesh(text_of(bytes), "warp.data", 24, 16);
    if (!mesh) return require_reason(mesh.error());
    require_whole(mesh->source_uv);
    require_whole(mesh->weights);
}

Seeds warp_mesh_seeds() {
    return {bytes_of(SampleMesh)};
}

void head_packet(Bytes bytes) {
    const auto head = tools::parse_head(text_of(bytes));
    if (!head) require_reason(head.error());
}

Seeds head_packet_seeds() {
    return {bytes_of("head 0.1 1.7 -2e-1"), bytes_of("0 1.7 0 1 0 0 0")};
}

}  // namespace

std::vector<Decoder> display_decoders() {
    return {{"display", display},
            {"mpcdi", mpcdi, mpcdi_seeds},
            {"pfm", pfm, pfm_seeds},
            {"warp-mesh", warp_mesh, warp_mesh_seeds},
            {"head-packet", head_packet, head_packet_seeds}};
}

}  // namespace tessera::fuzz
