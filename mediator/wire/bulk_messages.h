#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "mediator/base/description.h"
#include "mediator/base/hash.h"
#include "mediator/base/ids.h"
#include "mediator/frame/film_tile.h"
#include "mediator/session/view_request.h"
#include "mediator/view/view.h"

// Messages of the bulk link: a fixed little-endian header, whose fields are the rows in their order, then raw planes.
namespace tessera::wire {

inline constexpr std::size_t MaxChunk = std::size_t{1} << 20;

// Null, or why a chunk of this offset and size is invalid.
constexpr const char* malformed_piece(std::uint64_t total, std::uint64_t offset, std::size_t size) {
    if (size > MaxChunk) return "a chunk is longer than 1 MiB";
    return offset <= total && size <= total - offset ? nullptr : "a chunk extends beyond the total size";
}

struct BulkHello {
    std::uint64_t token = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "token", &BulkHello::token)); }
};
struct BlobRequest {
    Hash256 hash;
    std::uint64_t offset = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "hash", &BlobRequest::hash), row(2, "offset", &BlobRequest::offset));
    }
};
struct BlobChunk {
    Hash256 hash;
    std::uint64_t total = 0, offset = 0;
    std::vector<std::byte> data;  // at most 1 MiB
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "hash", &BlobChunk::hash), row(2, "total", &BlobChunk::total),
                          row(3, "offset", &BlobChunk::offset), row(4, "data", &BlobChunk::data));
    }
    const char* malformed() const { return malformed_piece(total, offset, data.size()); }
};
struct BlobAbsent {
    Hash256 hash;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "hash", &BlobAbsent::hash)); }
};
// Node to master: a block of film. It has the samples of one unit, of several units whose blocks are merged, or of a part
// of a unit that was stopped.
struct FilmPart {
    UnitId unit;  // one of them
    ViewId view;
    std::uint64_t revision = 0;
    Version version;
    std::uint32_t units = 1;    // that are complete with it
    std::uint64_t rays = 0;     // of these samples; of a stopped unit all are in its first block
    std::uint64_t busy_ns = 0;  // likewise
    frame::FilmTile film;
    static constexpr auto describe(auto row) {
        using Self = FilmPart;
        return std::tuple(row(1, "unit", &Self::unit), row(2, "view", &Self::view),
                          row(3, "revision", &Self::revision), row(4, "version", &Self::version),
                          row(5, "units", &Self::units), row(6, "rays", &Self::rays),
                          row(7, "busy_ns", &Self::busy_ns), row(8, "film", &Self::film));
    }
    const char* malformed() const;
};
// Master to client: a frame of a view, in front of its PictureChunks and FrameTiles, which have its number.
struct FrameHeader {
    std::uint64_t view = 0, frame = 0;  // the client's number of the view; frames count from 1
    Version version;                    // of the scene shown
    std::uint64_t revision = 0;         // of the view: grows with every change of its camera
    std::uint32_t scale = 1;            // 8, 4, 2: a coarse picture at 1/8, 1/4, 1/2 of the view's size
    std::uint32_t width = 0, height = 0, components = 0;
    session::PictureEncoding encoding = session::PictureEncoding::None;
    std::uint64_t picture_bytes = 0;
    Rect film_window;  // that the tiles cover; empty without film
    std::uint32_t film_tiles = 0;
    std::uint64_t min_samples = 0, max_samples = 0, spp = 0;  // per pixel, and the final number
    bool complete = false;
    Hash256 film_hash;          // when complete, of a view whose every frame is delivered
    double mean_samples = 0.0;  // per pixel
    double noise = 0.0;         // as in session::ViewProgress
    static constexpr auto describe(auto row) {
        using Self = FrameHeader;
        return std::tuple(
            row(1, "view", &Self::view), row(2, "frame", &Self::frame), row(3, "version", &Self::version),
            row(4, "revision", &Self::revision), row(5, "scale", &Self::scale), row(6, "width", &Self::width),
            row(7, "height", &Self::height), row(8, "components", &Self::components),
            row(9, "encoding", &Self::encoding, UpTo{session::PictureEncoding::Exr}),
            row(10, "picture_bytes", &Self::picture_bytes), row(11, "film_window", &Self::film_window),
            row(12, "film_tiles", &Self::film_tiles), row(13, "complete", &Self::complete),
            row(14, "min_samples", &Self::min_samples), row(15, "max_samples", &Self::max_samples),
            row(16, "spp", &Self::spp), row(17, "film_hash", &Self::film_hash),
            row(18, "mean_samples", &Self::mean_samples), row(19, "noise", &Self::noise));
    }
    const char* malformed() const;
};
// Master to client: the merged film of one tile.
struct FrameTile {
    std::uint64_t frame = 0;
    std::uint32_t index = 0, count = 0;
    frame::FilmTile film;  // `block` is unused: the counts are complete
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "frame", &FrameTile::frame), row(2, "index", &FrameTile::index),
                          row(3, "count", &FrameTile::count), row(4, "film", &FrameTile::film));
    }
    const char* malformed() const {
        return index < count ? nullptr : "a tile's index is not below the tile count";
    }
};
// Master to client, in place of FrameTile where the client asks for what continues the film: a block of film of a tile; or,
// with `is_wanted`, pixels that are to get the samples of the block, whose film has no samples and one channel. Of a client
// to the master: the same, in the content of a blob (film_state_codec.h).
struct FilmBlock {
    std::uint64_t frame = 0;
    std::uint32_t index = 0, count = 0;  // of the tile
    std::uint32_t left = 0;              // messages of the tile that follow
    bool is_wanted = false;
    frame::FilmTile film;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "frame", &FilmBlock::frame), row(2, "index", &FilmBlock::index),
                          row(3, "count", &FilmBlock::count), row(4, "left", &FilmBlock::left),
                          row(5, "is_wanted", &FilmBlock::is_wanted), row(6, "film", &FilmBlock::film));
    }
    const char* malformed() const;
};
// Master to client: a piece of the picture that the frame's header describes.
struct PictureChunk {
    std::uint64_t frame = 0;
    std::uint64_t total = 0, offset = 0;
    std::vector<std::byte> data;  // at most 1 MiB
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "frame", &PictureChunk::frame), row(2, "total", &PictureChunk::total),
                          row(3, "offset", &PictureChunk::offset), row(4, "data", &PictureChunk::data));
    }
    const char* malformed() const { return malformed_piece(total, offset, data.size()); }
};
// Master to output process: a piece of an eye's picture of a frame; pieces of one picture come in order.
struct OutputPicture {
    std::uint64_t frame = 0;
    view::Eye eye = view::Eye::Mono;
    std::uint32_t eyes = 1;   // pictures of this frame for this output
    Version version;          // of the scene shown
    view::CameraPose camera;  // camera it was rendered with, in display space
    std::uint32_t width = 0, height = 0;
    session::PictureEncoding encoding = session::PictureEncoding::Bytes;  // or Half
    std::uint64_t samples = 0;                                            // per pixel, in the mean
    std::uint64_t total = 0, offset = 0;                                  // bytes of the picture
    std::vector<std::byte> data;                                          // at most 1 MiB
    static constexpr auto describe(auto row) {
        using Self = OutputPicture;
        return std::tuple(
            row(1, "frame", &Self::frame), row(2, "eye", &Self::eye), row(3, "eyes", &Self::eyes),
            row(4, "version", &Self::version),
            row(
                5, "world_from_camera",
                [](auto& picture) -> auto& { return picture.camera.world_from_camera; }),
            row(6, "frustum",
                Computed{[](const Self& picture) { return picture.camera.edges(); },
                         [](Self& picture, const glm::dvec4& edges) { picture.camera.set_edges(edges); }}),
            row(7, "width", &Self::width), row(8, "height", &Self::height),
            row(9, "encoding", &Self::encoding), row(10, "samples", &Self::samples),
            row(11, "total", &Self::total), row(12, "offset", &Self::offset), row(13, "data", &Self::data));
    }
    const char* malformed() const;
};
}  // namespace tessera::wire
