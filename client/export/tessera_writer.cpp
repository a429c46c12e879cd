#include <algorithm>
#include <cctype>
#include <limits>

#include "client/export/durable_file.h"
#include "client/export/export.h"
#include "client/import/limits.h"
#include "client/import/tessera_format.h"
#include "mediator/wire/envelope.h"

namespace tessera::exporting {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

void write(const scene::Scene& scene, const scene::BlobStore& blobs, const std::filesystem::path& file) {
    const std::vector<scene::BlobRef> wanted = scene::referenced_blobs(scene);
    scene::ChangeList snapshot = scene::snapshot(scene);
    const std::vector<std::byte> list = wire::encode(snapshot);
    std::uint64_t size = import::TesseraHeaderBytes + list.size() + sizeof(Hash256::bytes);
    for (const scene::BlobRef& blob : wanted) size += sizeof(Hash256::bytes) + sizeof size + blob.byte_size;
    if (size > import::MaxFileBytes) {
        throw Error(ErrorCode::InvalidInput, "the scene takes more than the 4 GiB of a file: split it");
    }
    write_durably(file, [&](const Sink& sink) {
        Blake2b hash;
        const auto put = [&](std::span<const std::byte> bytes) {
            hash.update(bytes);
            sink(bytes);
        };
        put(std::as_bytes(std::span(import::TesseraMagic)));
        put(bytes_of(import::TesseraFormatVersion));
        put(bytes_of(static_cast<std::uint32_t>(wanted.size())));
        put(bytes_of(std::uint64_t{list.size()}));
        put(list);
        for (const scene::BlobRef& reference : wanted) {
            const scene::BlobPtr blob = blobs.find(reference.hash);
            if (!blob) {
                throw Error(ErrorCode::NotFound, "the bytes of blob " + to_hex(reference.hash) +
                                                     " are missing: load the scene again");
            }
            put(reference.hash.bytes);
            put(bytes_of(reference.byte_size));
            put(blob->bytes());
        }
        const Hash256 sum = hash.finish();
        sink(sum.bytes);
    });
}

}  // namespace

Expected<Notices> write_tessera(const scene::Scene& scene, const scene::BlobStore& blobs,
                                const std::filesystem::path& file) {
    try {
        write(scene, blobs, file);
        return Notices{};
    } catch (const Error& error) {
        return tl::unexpected<Error>(error);
    }
}

Expected<Notices> write_scene(const scene::Scene& scene, const scene::BlobStore& blobs,
                              const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".glb") return write_glb(scene, blobs, file);
    if (extension == ".tessera") return write_tessera(scene, blobs, file);
    return failure(
        ErrorCode::InvalidInput,
        "'" + file.string() + "' has neither of the extensions .glb and .tessera: use one of them");
}

}  // namespace tessera::exporting
