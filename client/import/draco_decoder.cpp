#include "client/import/draco_decoder.h"

#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <optional>
#include <string>

#include "client/import/limits.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

[[noreturn]] void reject_encoded(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, "its Draco data " + cause);
}

// What the connectivity of a mesh begins with.
struct DracoCounts {
    std::uint32_t vertices = 0, faces = 0;
    std::uint8_t tables = 0;  // with corners of attributes
};

// A number, since bitstream `first_packed` as a variable number of bytes.
std::uint32_t read_count(draco::DecoderBuffer& buffer, std::uint16_t first_packed) {
    std::uint32_t count = 0;
    const bool packed = buffer.bitstream_version() >= first_packed;
    if (!(packed ? draco::DecodeVarint(&count, &buffer) : buffer.Decode(&count)))
        reject_encoded("ends too early");
    return count;
}

constexpr std::uint16_t Version20 = DRACO_BITSTREAM_VERSION(2, 0), Version22 = DRACO_BITSTREAM_VERSION(2, 2);

DracoCounts read_counts(const draco::MeshSequentialDecoder&, draco::DecoderBuffer buffer) {
    DracoCounts counts;
    counts.faces = read_count(buffer, Version22);
    counts.vertices = read_count(buffer, Version22);
    return counts;
}

DracoCounts read_counts(const draco::MeshEdgebreakerDecoder&, draco::DecoderBuffer buffer) {
    DracoCounts counts;
    if (buffer.bitstream_version() < Version22) read_count(buffer, Version20);  // of new vertices
    counts.vertices = read_count(buffer, Version20);
    counts.faces = read_count(buffer, Version20);
    if (!buffer.Decode(&counts.tables)) reject_encoded("ends too early");
    return counts;
}

// Draco's decoder, which checks the counts that it comes across before it allocates. Draco may be compiled without
// exceptions, so that none may cross it.
template <class Base>
class CheckedDecoder final : public Base {
  public:
    CheckedDecoder(std::uint64_t byte_size, std::uint64_t most_faces)
        : byte_size_(byte_size), most_faces_(most_faces) {}

    const std::optional<Error>& refusal() const { return refusal_; }

  private:
    template <class Check>
    bool passes(Check check) {
        try {
            check();
            return true;
        } catch (const Error& error) {
            refusal_ = error;
            return false;
        }
    }

    bool DecodeConnectivity() override {
        return passes([&] { check(read_counts(*this, *this->buffer())); }) && Base::DecodeConnectivity();
    }
    bool DecodeAllAttributes() override {
        return passes([&] { check_attributes(); }) && Base::DecodeAllAttributes();
    }

    void check(const DracoCounts& counts) const {
        const std::string claim = "claims " + std::to_string(counts.faces) + " triangles, ";
        if (counts.faces > MaxDracoFaces)
            reject_encoded(claim + "more than the " + std::to_string(MaxDracoFaces) + " that are read");
        if (counts.faces > most_faces_)
            reject_encoded(claim + "but its indices state " + std::to_string(most_faces_));
        if (counts.faces > byte_size_ * MaxDracoFacesPerByte)
            reject_encoded(claim + "but has only " + std::to_string(byte_size_) + " bytes");
        const std::uint64_t corners = std::uint64_t{counts.faces} * 3;
        if (counts.vertices > corners) reject_encoded("claims more vertices than corners of triangles");
        if (corners * counts.tables > MaxElements) reject_encoded("claims too many attributes");
    }
    void check_attributes() const {
        std::uint64_t numbers = 0;  // of a point
        for (int i = 0; i < this->point_cloud()->num_attributes(); ++i)
            numbers += this->point_cloud()->attribute(i)->num_components();
        if (numbers * this->point_cloud()->num_points() > MaxElements)
            reject_encoded("claims too many numbers in its attributes");
    }

    std::uint64_t byte_size_, most_faces_;
    std::optional<Error> refusal_;
};

template <class Base>
std::unique_ptr<draco::Mesh> decode(std::span<const unsigned char> bytes, std::uint64_t most_faces) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    CheckedDecoder<Base> decoder(bytes.size(), most_faces);
    auto mesh = std::make_unique<draco::Mesh>();
    const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, mesh.get());
    if (decoder.refusal()) throw *decoder.refusal();
    if (!status.ok()) reject_encoded("cannot be decoded (" + status.error_msg_string() + ")");
    const std::uint64_t most = std::min(most_faces, MaxDracoFaces);
    if (mesh->num_faces() > most || mesh->num_points() > 3 * most) reject_encoded("has too many elements");
    for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
        for (const draco::PointIndex point : mesh->face(face))
            if (point >= mesh->num_points())
                reject_encoded("has a triangle with a vertex that does not exist");
    }
    return mesh;
}

}  // namespace

std::unique_ptr<draco::Mesh> decode_draco_mesh(std::span<const unsigned char> bytes,
                                               std::uint64_t most_faces) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::DracoHeader header{};
    const draco::Status status = draco::PointCloudDecoder::DecodeHeader(&buffer, &header);
    if (!status.ok()) reject_encoded("cannot be decoded (" + status.error_msg_string() + ")");
    if (header.encoder_type != draco::TRIANGULAR_MESH) reject_encoded("is not a mesh");
    if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
        return decode<draco::MeshEdgebreakerDecoder>(bytes, most_faces);
    if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
        return decode<draco::MeshSequentialDecoder>(bytes, most_faces);
    reject_encoded("has an unknown encoding");
}

}  // namespace tessera::import
