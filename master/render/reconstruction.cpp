#include "master/render/reconstruction.h"

#include <algorithm>
#include <cstring>

#include "master/filter/catalog.h"
#include "master/filter/upsample.h"
#include "mediator/picture/picture_encoder.h"

namespace tessera::master {

namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

frame::Image interleaved(const filter::Planes& planes) {
    frame::Image image(planes.width(), planes.height(), planes.components());
    for (std::uint32_t c = 0; c < planes.components(); ++c) {
        const auto plane = planes.plane(c);
        for (std::size_t i = 0; i < plane.size(); ++i) image.values[i * planes.components() + c] = plane[i];
    }
    return image;
}

std::vector<std::byte> encode(const filter::Planes& picture, wire::PictureEncoding encoding) {
    switch (encoding) {
        case wire::PictureEncoding::Png:
            return picture::encode_picture(interleaved(picture), picture::FileFormat::Png);
        case wire::PictureEncoding::Jpeg:
            return picture::encode_picture(interleaved(picture), picture::FileFormat::Jpeg);
        case wire::PictureEncoding::Exr:
            return picture::encode_picture(interleaved(picture), picture::FileFormat::Exr);
        case wire::PictureEncoding::Planes:
        case wire::PictureEncoding::None:
        case wire::PictureEncoding::Bytes:  // of outputs: master/render/output_maker.h
        case wire::PictureEncoding::Half:
            break;
    }
    const auto bytes = std::as_bytes(picture.values());
    return {bytes.begin(), bytes.end()};
}

}  // namespace

filter::Filter& Reconstructor::instance(const filter::Choice& choice, std::uint32_t width,
                                        std::uint32_t height) {
    const std::string name(choice.entry->description.name);
    if (!instance_.filter || instance_.name != name || instance_.width != width ||
        instance_.height != height) {
        instance_ = {name, width, height, choice.entry->make(width, height)};
    }
    return *instance_.filter;
}

Reconstruction Reconstructor::reconstruct(const Films& films, const view::View& view,
                                          wire::PictureEncoding encoding) {
    Reconstruction result{.bytes = std::make_shared<const std::vector<std::byte>>()};
    wire::PictureSummary& summary = result.summary;
    const auto choice = filter::parse_choice(view.filter, filter::catalog());
    if (!choice) {
        result.error = choice.error().what();
        return result;
    }
    summary.filter = filter::to_text(*choice);
    try {
        const auto started = Clock::now();
        const filter::Inputs inputs = filter::make_inputs(films.film, view, films.later);
        filter::Filter& filter = instance(*choice, inputs.width, inputs.height);
        filter.reset();
        const filter::Report report = filter.run(inputs, choice->values, output_, {arena_, {}});
        const filter::Planes* picture = &output_.picture;
        if (films.features != nullptr) {
            const filter::Inputs full = filter::make_inputs(*films.features, view);
            filter::upsample(output_.picture, inputs, full, upsampled_, {arena_, {}});
            picture = &upsampled_;
        }
        summary.seconds_filter = since(started);
        for (const filter::Pass& pass : report.passes) {
            summary.passes.push_back({std::string(pass.name), seconds(pass.time), pass.bytes_per_pixel});
        }
        summary.notes = report.notes;
        const auto filtered = Clock::now();
        result.bytes = std::make_shared<const std::vector<std::byte>>(encode(*picture, encoding));
        summary.seconds_encode = since(filtered);
        summary.encoding = encoding;
        summary.width = picture->width();
        summary.height = picture->height();
        summary.components = picture->components();
        summary.byte_size = result.bytes->size();
    } catch (const std::exception& error) {
        result.error = "the filter " + summary.filter + " failed: " + error.what();
    }
    return result;
}

const filter::Planes& Reconstructor::filtered(const frame::FilmTile& film, const view::View& view) {
    const auto choice = filter::parse_choice(view.filter, filter::catalog());
    if (!choice) throw choice.error();
    const filter::Inputs inputs = filter::make_inputs(film, view);
    filter::Filter& filter = instance(*choice, inputs.width, inputs.height);
    filter.reset();
    filter.run(inputs, choice->values, output_, {arena_, {}});
    return output_.picture;
}

double Reconstructor::rehearse(const view::View& view, wire::PictureEncoding encoding, std::uint32_t width,
                               std::uint32_t height) {
    const Rect rect{0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    frame::FilmTile film(rect, {0, 2}, view.channels);
    std::fill(film.counts.begin(), film.counts.end(), 4u);
    std::uint32_t state = 1;
    for (float& value : film.planes) {
        state = state * 1664525u + 1013904223u;
        value = static_cast<float>(state >> 8) * 0x1p-24f;
    }
    const auto started = Clock::now();
    reconstruct({.film = film}, view, encoding);
    return since(started);
}

}  // namespace tessera::master
