#include "mediator/picture/exr_writer.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <exception>

#include "mediator/base/error.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::picture {

namespace {

std::string channel_name(const Layer& layer, std::size_t component) {
    return (layer.name.empty() ? "" : layer.name + ".") + layer.components[component];
}

// One plane per channel. EXR needs the address of pixel (0, 0), which may be outside the window.
void insert(Imf::FrameBuffer& frame_buffer, const Layer& layer, const Rect& window) {
    const std::size_t x_stride = layer.image.components * sizeof(float);
    const std::size_t y_stride = x_stride * layer.image.width;
    for (std::size_t c = 0; c < layer.components.size(); ++c) {
        const char* first = reinterpret_cast<const char*>(layer.image.values.data() + c);
        char* origin = const_cast<char*>(first) - window.x * static_cast<std::ptrdiff_t>(x_stride) -
                       window.y * static_cast<std::ptrdiff_t>(y_stride);
        frame_buffer.insert(channel_name(layer, c), Imf::Slice(layer.as_integers ? Imf::UINT : Imf::FLOAT,
                                                               origin, x_stride, y_stride));
    }
}

}  // namespace

void write_exr(const std::string& path, std::uint32_t width, std::uint32_t height, const Rect& window,
               const std::vector<Layer>& layers, const std::map<std::string, std::string>& attributes) {
    write_atomically(path, [&](const std::string& temporary) {
        try {
            const Imath::Box2i display({0, 0}, {static_cast<int>(width) - 1, static_cast<int>(height) - 1});
            const Imath::Box2i data({window.x, window.y}, {window.right() - 1, window.bottom() - 1});
            Imf::Header header(display, data);
            header.compression() = Imf::ZIP_COMPRESSION;
            for (const auto& [name, value] : attributes) header.insert(name, Imf::StringAttribute(value));
            Imf::FrameBuffer frame_buffer;
            for (const Layer& layer : layers) {
                for (std::size_t c = 0; c < layer.components.size(); ++c) {
                    header.channels().insert(channel_name(layer, c),
                                             Imf::Channel(layer.as_integers ? Imf::UINT : Imf::FLOAT));
                }
                insert(frame_buffer, layer, window);
            }
            Imf::OutputFile file(temporary.c_str(), header);
            file.setFrameBuffer(frame_buffer);
            file.writePixels(window.height);
        } catch (const std::exception& error) {
            throw Error(ErrorCode::Io, "cannot write '" + path + "': " + error.what());
        }
    });
}

void set_exr_threads(std::uint32_t count) {
    Imf::setGlobalThreadCount(static_cast<int>(count));
}

}  // namespace tessera::picture
