#include "client/import/image_decoder.h"
#include "client/import/limits.h"
#include "mediator/picture/exr_reader.h"
#include "mediator/picture/exr_writer.h"
#include "mediator/picture/film_exr.h"
#include "mediator/picture/hdr_reader.h"
#include "mediator/picture/picture_encoder.h"
#include "mediator/picture/png_reader.h"
#include "mediator/picture/png_writer.h"
#include "tests/fuzz/decoders/decoder.h"

// Pictures: textures, environments, weights of projectors, and film.
namespace tessera::fuzz {

namespace {

void require_whole(const frame::Image& image) {
    require(image.width > 0 && image.height > 0 && image.components > 0, "a picture is empty");
    require(image.values.size() == image.pixel_count() * image.components, "a picture lacks pixels");
}

void require_whole(const picture::RgbaImage& image) {
    require(image.width > 0 && image.height > 0, "a picture is empty");
    require(image.rgba.size() == std::size_t{4} * image.width * image.height, "a picture lacks pixels");
}

void exr(Bytes bytes) {
    const std::string path = file_of("picture.exr", bytes).string();
    accepts([&] {
        const picture::Picture picture = picture::read_exr(path);
        require_whole(picture.image);
        require(picture.window.width == static_cast<std::int32_t>(picture.image.width) &&
                    picture.window.height == static_cast<std::int32_t>(picture.image.height),
                "a picture has another size than its window");
    });
    accepts([&] {
        const picture::FilmFile file = picture::read_film_exr(path, picture::State::Included);
        require(file.film.counts.size() == file.film.pixel_count(), "film lacks pixels");
        if (!file.state) return;
        for (const frame::FilmTile& block : file.state->blocks)
            require(intersection(block.rect, file.film.rect) == block.rect, "a block is outside the film");
    });
}

frame::Image gradient(std::uint32_t components) {
    frame::Image image(5, 3, components);
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = 0.1f * static_cast<float>(i);
    return image;
}

Seeds exr_seeds() {
    frame::FilmTile film({0, 0, 3, 2}, {0, 1}, {frame::Channel::Radiance, frame::Channel::ObjectIndex});
    std::fill(film.counts.begin(), film.counts.end(), 2u);
    const std::string path = file_of("new.exr", {}).string();
    picture::write_film_exr(path, {3, 2, film, {}}, {}, picture::Statistics::Include);
    const std::vector<std::byte> with_statistics = content_of(path);
    frame::FilmTile later = film;
    later.block = {2, 1};
    picture::write_film_exr(
        path, {3, 2, film, {}, frame::FilmState{.blocks = {film, later}, .steps = 0, .wanted = {}}}, {},
        picture::Statistics::Include);
    return {with_statistics, content_of(path),
            picture::encode_picture(gradient(3), picture::FileFormat::Exr, view::DisplayTransform{}),
            picture::encode_picture(gradient(4), picture::FileFormat::Exr, view::DisplayTransform{})};
}

void hdr(Bytes bytes) {
    accepts([&] { require_whole(picture::decode_hdr(bytes)); });
}

void png(Bytes bytes) {
    const auto floats = picture::read_png(bytes);
    if (floats) {
        require_whole(*floats);
    } else {
        require_reason(floats.error());
    }
    const auto deep = picture::read_png16(bytes, import::ImageLimits);
    if (!deep) {
        require_reason(deep.error());
    } else if (*deep) {
        require_whole(**deep);
    }
    const auto rgba = picture::read_png_rgba(bytes, import::ImageLimits);
    if (!rgba) return require_reason(rgba.error());
    require_whole(*rgba);
}

Seeds png_seeds() {
    const std::vector<std::uint8_t> rgba(std::size_t{4} * 5 * 3, 77);
    return {picture::encode_rgba_png(5, 3, rgba), picture::encode_png16(4, 2, std::vector<float>(24, 0.3f)),
            picture::encode_picture(gradient(3), picture::FileFormat::Png, view::DisplayTransform{})};
}

// Any format of textures: its first bytes decide.
void texture(Bytes bytes) {
    const auto image =
        import::decode_image({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
    if (!image) return require_reason(image.error());
    require_whole(*image);
}

Seeds jpeg_seeds() {
    return {picture::encode_picture(gradient(3), picture::FileFormat::Jpeg, view::DisplayTransform{})};
}

}  // namespace

std::vector<Decoder> picture_decoders() {
    return {{"exr", exr, exr_seeds},
            {"hdr", hdr},
            {"png", png, png_seeds},
            {"jpeg", texture, jpeg_seeds},
            {"texture", texture, png_seeds}};
}

}  // namespace tessera::fuzz
