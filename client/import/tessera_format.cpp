#include "client/import/tessera_format.h"

#include <cstring>
#include <span>
#include <string>

#include "client/import/local_files.h"
#include "mediator/scene/scene.h"
#include "mediator/scene/validate.h"
#include "mediator/wire/envelope.h"

namespace tessera::import {
namespace {

[[noreturn]] void reject_tessera(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, "it is damaged (" + cause + "): copy or save it again");
}

// Reads bytes in sequence; throws at the end.
class Cursor {
  public:
    explicit Cursor(std::span<const std::byte> bytes) : rest_(bytes) {}
    std::span<const std::byte> take(std::uint64_t count) {
        if (count > rest_.size()) reject_tessera("it is shorter than its header says");
        const auto taken = rest_.first(static_cast<std::size_t>(count));
        rest_ = rest_.subspan(taken.size());
        return taken;
    }
    template <class T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    bool at_end() const { return rest_.empty(); }

  private:
    std::span<const std::byte> rest_;
};

Hash256 hash_of(std::span<const std::byte> bytes) {
    Hash256 hash;
    std::memcpy(hash.bytes.data(), bytes.data(), hash.bytes.size());
    return hash;
}

std::vector<scene::BlobPtr> read_blobs(Cursor& cursor, std::uint32_t count,
                                       const std::vector<scene::BlobRef>& wanted) {
    if (count != wanted.size()) reject_tessera("it does not contain the blobs that its scene refers to");
    std::vector<scene::BlobPtr> blobs;
    for (const scene::BlobRef& reference : wanted) {
        const Hash256 hash = hash_of(cursor.take(sizeof(Hash256::bytes)));
        const auto byte_size = cursor.number<std::uint64_t>();
        if (hash != reference.hash || byte_size != reference.byte_size) {
            reject_tessera("it does not contain the blobs that its scene refers to");
        }
        blobs.push_back(std::make_shared<const scene::Blob>(cursor.take(byte_size)));
        if (blobs.back()->hash() != hash) reject_tessera("the hash of a blob does not match its content");
    }
    return blobs;
}

void check(const std::vector<scene::Problem>& problems) {
    if (!problems.empty()) reject_tessera(problems.front().message);
}

TesseraFile read(std::span<const std::byte> bytes) {
    Cursor frame(bytes);
    if (std::memcmp(frame.take(TesseraMagic.size()).data(), TesseraMagic.data(), TesseraMagic.size()) != 0) {
        throw Error(ErrorCode::InvalidInput, "it is not a .tessera file: check the name");
    }
    if (const auto version = frame.number<std::uint32_t>(); version != TesseraFormatVersion) {
        throw Error(ErrorCode::InvalidInput, "its format version is " + std::to_string(version) + ", not " +
                                                 std::to_string(TesseraFormatVersion) +
                                                 ": read it with the software that wrote it");
    }
    constexpr std::size_t HashBytes = sizeof(Hash256::bytes);
    if (bytes.size() < TesseraHeaderBytes + HashBytes) reject_tessera("it ends too early");
    const auto content = bytes.first(bytes.size() - HashBytes);
    if (blake2b(content) != hash_of(bytes.last(HashBytes)))
        reject_tessera("its checksum does not match its content");

    Cursor cursor(content.subspan(TesseraMagic.size() + sizeof(std::uint32_t)));
    const auto blob_count = cursor.number<std::uint32_t>();
    const auto list_size = cursor.number<std::uint64_t>();
    auto snapshot = wire::decode_change_list(cursor.take(list_size));
    if (!snapshot) reject_tessera(snapshot.error().what());
    if (!snapshot->is_snapshot()) reject_tessera("its change list is not a snapshot");
    scene::Scene scene;
    if (const auto applied = scene.apply(*snapshot); !applied) reject_tessera(applied.error().what());
    check(scene::validate(scene));

    TesseraFile file{std::move(*snapshot), read_blobs(cursor, blob_count, scene::referenced_blobs(scene))};
    if (!cursor.at_end()) reject_tessera("it has trailing bytes");
    scene::BlobStore store;
    for (const scene::BlobPtr& blob : file.blobs) store.insert(blob);
    for (const auto& [id, object] : scene.objects()) check(scene::validate_blobs(id, *object, store));
    return file;
}

}  // namespace

Expected<TesseraFile> read_tessera(const std::filesystem::path& file) {
    const auto bytes = read_whole_file(file);
    if (!bytes) return tl::unexpected<Error>(bytes.error());
    try {
        return read(std::as_bytes(std::span(*bytes)));
    } catch (const Error& error) {
        return tl::unexpected<Error>(error);
    }
}

}  // namespace tessera::import
