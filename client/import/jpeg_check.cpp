#include "client/import/jpeg_check.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "client/import/limits.h"

namespace tessera::import {
namespace {

enum JpegMarker : unsigned char {
    HuffmanTables = 0xc4,
    Restart0 = 0xd0,
    Restart7 = 0xd7,
    EndOfImage = 0xd9,
    StartOfScan = 0xda
};

struct JpegFrame {
    std::uint64_t width = 0, height = 0;
    std::uint64_t least_bits = 0;
    std::uint64_t scans = 0;
    std::uint64_t most_codes = 0;  // of a Huffman table
    bool is_progressive = false;
    std::array<std::array<bool, 4>, 2> has_table{};  // DC and AC, by number
    bool lacks_table = false;                        // a scan needs one that no segment before it has
};

bool starts_frame(unsigned char marker) {
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

bool has_length(unsigned char marker) {
    return marker > 0x01 && !(marker >= Restart0 && marker <= Restart7) && marker != 0xd8;
}

std::uint64_t divided_up(std::uint64_t value, std::uint64_t by) {
    return (value + by - 1) / by;
}

// `segment` begins after the length.
void read_frame(std::span<const unsigned char> segment, unsigned char marker, JpegFrame& frame) {
    if (segment.size() < 6) return;
    frame.height = segment[1] * 256u + segment[2];
    frame.width = segment[3] * 256u + segment[4];
    frame.is_progressive = marker == 0xc2;
    struct Sampling {
        std::uint64_t across, down;
    };
    std::vector<Sampling> components;
    Sampling most{1, 1};
    for (std::size_t at = 6; at + 3 <= segment.size() && components.size() < segment[5]; at += 3) {
        components.push_back({segment[at + 1] / 16u, segment[at + 1] % 16u});
        most = {std::max(most.across, components.back().across), std::max(most.down, components.back().down)};
    }
    const std::uint64_t bits_per_block = frame.is_progressive ? 1 : 2;
    frame.least_bits = 0;
    for (const Sampling& sampling : components) {
        frame.least_bits += divided_up(divided_up(frame.width * sampling.across, most.across), 8) *
                            divided_up(divided_up(frame.height * sampling.down, most.down), 8) *
                            bits_per_block;
    }
}

// The tables of a segment, as stb_image goes through them: one may extend beyond the segment or the file, which is an error
// only afterwards.
void read_tables(std::span<const unsigned char> rest, std::size_t length, JpegFrame& frame) {
    constexpr std::size_t Lengths = 16;
    while (length > 0 && !rest.empty()) {
        std::size_t codes = 0;
        for (const unsigned char count : rest.subspan(1, std::min(Lengths, rest.size() - 1))) codes += count;
        frame.most_codes = std::max<std::uint64_t>(frame.most_codes, codes);
        const std::size_t kind = rest[0] / 16u, number = rest[0] % 16u;
        if (kind < 2 && number < 4) frame.has_table[kind][number] = true;
        const std::size_t size = 1 + Lengths + codes;
        length -= std::min(length, size);
        rest = rest.subspan(std::min(rest.size(), size));
    }
}

// The tables that a scan reads: all scans of a baseline image both kinds, those of a progressive one DC in the first scan
// of the lowest frequency, none in its refinements, and AC in the others. `segment` begins after the length.
void read_scan(std::span<const unsigned char> segment, JpegFrame& frame) {
    if (segment.empty() || segment.size() < 4 + 2 * std::size_t{segment[0]}) return;
    const std::size_t components = segment[0];
    const unsigned char first_frequency = segment[1 + 2 * components], bits = segment[3 + 2 * components];
    const bool needs_dc = !frame.is_progressive || (first_frequency == 0 && bits / 16u == 0);
    const bool needs_ac = !frame.is_progressive || first_frequency != 0;
    for (std::size_t i = 0; i < components; ++i) {
        const std::size_t dc = segment[2 + 2 * i] / 16u, ac = segment[2 + 2 * i] % 16u;
        if (dc >= 4 || ac >= 4) return;  // an error of the decoder
        frame.lacks_table |= (needs_dc && !frame.has_table[0][dc]) || (needs_ac && !frame.has_table[1][ac]);
    }
}

// Position of the next marker's code from `at`; the size of the bytes if there is none. Within a scan, 0 and the codes
// of restarts belong to the data.
enum class Within { Headers, Scan };
std::size_t next_marker(std::span<const unsigned char> bytes, std::size_t at, Within within) {
    for (; at + 1 < bytes.size(); ++at) {
        if (bytes[at] != 0xff || bytes[at + 1] == 0xff || bytes[at + 1] == 0) continue;
        const bool restart = bytes[at + 1] >= Restart0 && bytes[at + 1] <= Restart7;
        if (!restart || within == Within::Headers) return at + 1;
    }
    return bytes.size();
}

JpegFrame read_frame(std::span<const unsigned char> bytes) {
    JpegFrame frame;
    for (std::size_t at = next_marker(bytes, 2, Within::Headers); at < bytes.size();) {
        const unsigned char marker = bytes[at++];
        if (marker == EndOfImage) break;
        Within within = Within::Headers;
        if (has_length(marker)) {
            if (bytes.size() - at < 2) break;
            const std::size_t length = bytes[at] * 256u + bytes[at + 1];
            if (length < 2) break;
            if (marker == HuffmanTables) read_tables(bytes.subspan(at + 2), length - 2, frame);
            if (length > bytes.size() - at) break;
            if (starts_frame(marker) && frame.width == 0)  // stb_image uses the first one
                read_frame(bytes.subspan(at + 2, length - 2), marker, frame);
            if (marker == StartOfScan) {
                ++frame.scans;
                read_scan(bytes.subspan(at + 2, length - 2), frame);
                within = Within::Scan;
            }
            at += length;
        }
        at = next_marker(bytes, at, within);
    }
    return frame;
}

}  // namespace

Expected<void> check_jpeg(std::span<const unsigned char> bytes) {
    const JpegFrame frame = read_frame(bytes);
    const std::uint64_t pixels = frame.width * frame.height;
    const std::string claim = "the image claims " + std::to_string(frame.width) + " x " +
                              std::to_string(frame.height) + " pixels, ";
    if (std::max(frame.width, frame.height) > MaxImageEdge || pixels > MaxImagePixels)
        return failure(ErrorCode::InvalidInput, claim + "more than the " + std::to_string(MaxImagePixels) +
                                                    " that are read: scale it down");
    if (frame.least_bits / 8 > bytes.size())
        return failure(ErrorCode::InvalidInput,
                       claim + "but has only " + std::to_string(bytes.size()) + " bytes: save it again");
    // stb_image 2.27 writes beyond its array of 256.
    if (frame.most_codes > 256)
        return failure(ErrorCode::InvalidInput, "the image has a Huffman table of " +
                                                    std::to_string(frame.most_codes) +
                                                    " codes, more than 256: save it again");
    // stb_image 2.27 decodes with whatever its memory contained.
    if (frame.lacks_table)
        return failure(ErrorCode::InvalidInput,
                       "the image lacks a Huffman table that its data needs: save it again");
    if (frame.scans > MaxJpegScans || frame.scans * pixels > MaxJpegScanPixels)
        return failure(ErrorCode::InvalidInput,
                       claim + "in " + std::to_string(frame.scans) +
                           " scans, which takes too long: save it as a baseline JPEG");
    return {};
}

}  // namespace tessera::import
