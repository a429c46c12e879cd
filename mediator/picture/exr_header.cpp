#include "mediator/picture/exr_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::picture {

namespace {

Error damaged(const std::string& reason) {
    return Error(ErrorCode::InvalidInput, reason + ": write it again");
}

// Little-endian; so are all supported hosts.
class Reader {
  public:
    explicit Reader(const std::string& path) : file_(path, std::ios::binary) {
        file_.seekg(0, std::ios::end);
        size_ = static_cast<std::int64_t>(file_.tellg());
        file_.seekg(0);
        if (!file_ || size_ < 0) throw Error(ErrorCode::Io, "it cannot be opened: check its rights");
    }
    template <class T>
    T value() {
        T result{};
        file_.read(reinterpret_cast<char*>(&result), sizeof result);
        require_good();
        return result;
    }
    std::string text() {
        constexpr std::size_t LongestName = 255;
        std::string result;
        for (char letter = value<char>(); letter != '\0'; letter = value<char>()) {
            if (result.size() == LongestName) throw damaged("its header has an unterminated name");
            result += letter;
        }
        return result;
    }
    void skip(std::int64_t bytes) {
        if (bytes < 0 || bytes > size_ - position())
            throw damaged("its header has an attribute that is larger than the file");
        file_.seekg(bytes, std::ios::cur);
    }

    void seek(std::int64_t position) { file_.seekg(position); }
    std::int64_t position() { return static_cast<std::int64_t>(file_.tellg()); }
    std::int64_t size() const { return size_; }

  private:
    void require_good() {
        if (!file_) throw damaged("it ends in the middle of its header");
    }
    std::ifstream file_;
    std::int64_t size_ = 0;
};

struct Storage {
    std::uint8_t compression = 0;
    bool tiled = false;
    std::array<std::uint32_t, 2> tile{};
};

struct ExrChannel {
    std::int32_t byte_size = 0, x_sampling = 0, y_sampling = 0;
};

// Of a compression, by its number in files: the scan lines of a chunk, and an upper bound of raw bytes per compressed
// byte.
struct Compression {
    std::int64_t lines = 1, ratio = 1;
};
constexpr std::int64_t DeflateRatio = 1032;  // RFC 1951: at most 258 bytes per two bits
constexpr std::array<Compression, 10> Compressions{{
    {1, 1},                        // none
    {1, 64},                       // RLE: runs of at most 128 bytes in two
    {1, DeflateRatio},             // ZIPS
    {16, DeflateRatio},            // ZIP
    {32, DeflateRatio},            // PIZ: Huffman codes with runs of 256 half floats in ten bits
    {16, DeflateRatio * 4 / 3},    // PXR24: deflate after one of four bytes is dropped
    {32, 3},                       // B44: 32 bytes in 14
    {32, 11},                      // B44A: 32 bytes in three
    {32, std::int64_t{1} << 15},   // DWAA: quantised cosine transform, then Huffman codes or deflate
    {256, std::int64_t{1} << 15},  // DWAB
}};

Rect checked_window(const std::array<std::int32_t, 4>& box, const PictureLimits& limits) {
    const auto [left, top, right, bottom] = box;
    const std::int64_t width = std::int64_t{right} - left + 1, height = std::int64_t{bottom} - top + 1;
    constexpr std::int64_t MaxCoordinate = std::int64_t{1} << 30;
    if (width < 1 || height < 1 || std::abs(std::int64_t{left}) > MaxCoordinate ||
        std::abs(std::int64_t{top}) > MaxCoordinate) {
        throw damaged("its data window is empty or out of range");
    }
    if (width > limits.side || height > limits.side || width * height > limits.pixels) {
        throw Error(ErrorCode::InvalidInput, "it claims " + std::to_string(width) + " x " +
                                                 std::to_string(height) + " pixels, more than the " +
                                                 std::to_string(limits.pixels) +
                                                 " that are supported: scale it down");
    }
    return {left, top, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
}

// Returns whether the pixels are in tiles.
bool check_version(Reader& reader) {
    constexpr std::uint32_t Magic = 20000630, NumberMask = 0xff, Tiled = 0x200, Deep = 0x800,
                            SeveralParts = 0x1000;
    if (reader.value<std::uint32_t>() != Magic) throw damaged("it is not an OpenEXR file");
    const auto version = reader.value<std::uint32_t>();
    if ((version & NumberMask) != 2) throw damaged("its version of OpenEXR is not 2");
    if (version & (Deep | SeveralParts)) {
        throw Error(ErrorCode::InvalidInput, "it has deep pixels or several parts: save it as one flat part");
    }
    return (version & Tiled) != 0;
}

std::vector<ExrChannel> read_channels(Reader& reader, std::int32_t size) {
    const std::int64_t end = reader.position() + size;
    std::vector<ExrChannel> channels;
    while (!reader.text().empty()) {
        const auto type = reader.value<std::int32_t>();
        reader.skip(4);  // whether it is linear, and three reserved bytes
        const auto sampling = reader.value<std::array<std::int32_t, 2>>();
        constexpr std::int32_t Half = 1, Types = 3;
        if (type < 0 || type >= Types || sampling[0] < 1 || sampling[1] < 1)
            throw damaged("its header has an impossible channel");
        channels.push_back({type == Half ? 2 : 4, sampling[0], sampling[1]});
    }
    if (reader.position() != end) throw damaged("its list of channels has a wrong size");
    return channels;
}

// OpenEXR reads as much as the type takes, whatever size the header states; then it would take other bytes than we do for
// the next attribute, and allocate what these claim.
void check_attribute(Reader& reader, const std::string& type, std::int32_t size) {
    struct Fixed {
        std::string_view type;
        std::int32_t size;
    };
    constexpr std::array Types{Fixed{"box2f", 16},
                               Fixed{"box2i", 16},
                               Fixed{"chromaticities", 32},
                               Fixed{"compression", 1},
                               Fixed{"deepImageState", 1},
                               Fixed{"double", 8},
                               Fixed{"envmap", 1},
                               Fixed{"float", 4},
                               Fixed{"int", 4},
                               Fixed{"keycode", 28},
                               Fixed{"lineOrder", 1},
                               Fixed{"m33d", 72},
                               Fixed{"m33f", 36},
                               Fixed{"m44d", 128},
                               Fixed{"m44f", 64},
                               Fixed{"rational", 8},
                               Fixed{"tiledesc", 9},
                               Fixed{"timecode", 8},
                               Fixed{"v2d", 16},
                               Fixed{"v2f", 8},
                               Fixed{"v2i", 8},
                               Fixed{"v3d", 24},
                               Fixed{"v3f", 12},
                               Fixed{"v3i", 12}};
    const std::int64_t begin = reader.position();
    if (type == "chlist") {
        (void)read_channels(reader, size);
    } else if (type == "preview") {
        const std::int64_t width = reader.value<std::uint32_t>(), height = reader.value<std::uint32_t>();
        if (width > size || height > size || width * height != (size - 8) / 4 || size % 4 != 0)
            throw damaged("its preview has another size than its header says");
    } else if (const auto fixed = std::ranges::find(Types, type, &Fixed::type);
               fixed != Types.end() && fixed->size != size) {
        throw damaged("its header has an attribute of the type " + type + " and of a wrong size");
    }
    reader.seek(begin);
}

void check_storage(const Storage& storage, const std::vector<ExrChannel>& channels, const Rect& window,
                   std::int64_t file_size) {
    if (storage.compression >= Compressions.size()) throw damaged("its compression is unknown");
    const Compression& compression = Compressions[storage.compression];
    const std::int64_t width = window.width, height = window.height;
    std::int64_t raw = 0;
    for (const ExrChannel& channel : channels)
        raw += (width / channel.x_sampling) * (height / channel.y_sampling) * channel.byte_size;
    std::int64_t chunks = (height + compression.lines - 1) / compression.lines;
    std::int64_t chunk_bytes = 16;  // an offset, the first line and a size
    if (storage.tiled) {
        // A tile may be larger than a small picture.
        constexpr std::int64_t SmallTile = std::int64_t{2048} * 2048;
        const std::int64_t across = storage.tile[0], down = storage.tile[1];
        if (across < 1 || down < 1) throw damaged("its tiles are empty");
        if (across > MaxPicturePixels || down > MaxPicturePixels ||
            across * down > std::max(SmallTile, width * height)) {
            throw damaged("its tiles are too large");
        }
        chunks = ((width + across - 1) / across) * ((height + down - 1) / down);
        chunk_bytes = 28;  // an offset, four coordinates and a size
    }
    if (raw / compression.ratio > file_size || chunks * chunk_bytes > file_size) {
        throw damaged("it claims " + std::to_string(width) + " x " + std::to_string(height) +
                      " pixels, but has only " + std::to_string(file_size) + " bytes");
    }
}

}  // namespace

Rect checked_exr_window(const std::string& path, const PictureLimits& limits) {
    Reader reader(path);
    Storage storage;
    storage.tiled = check_version(reader);
    std::optional<Rect> window;
    std::vector<ExrChannel> channels;
    for (std::string name = reader.text(); !name.empty(); name = reader.text()) {
        const std::string type = reader.text();
        const auto size = reader.value<std::int32_t>();
        check_attribute(reader, type, size);
        if (name == "dataWindow" && size == sizeof(std::array<std::int32_t, 4>)) {
            window = checked_window(reader.value<std::array<std::int32_t, 4>>(), limits);
        } else if (name == "tiles" && size >= 8) {
            storage.tile = reader.value<std::array<std::uint32_t, 2>>();
            reader.skip(size - 8);
        } else if (name == "compression" && size == 1) {
            storage.compression = reader.value<std::uint8_t>();
        } else if (name == "channels") {
            channels = read_channels(reader, size);
        } else {
            reader.skip(size);
        }
    }
    if (!window) throw damaged("its header has no data window");
    check_storage(storage, channels, *window, reader.size());
    return *window;
}

}  // namespace tessera::picture
