#include "client/import/scene_transfer.h"

#include <algorithm>

#include "client/import/limits.h"
#include "mediator/scene/scene.h"
#include "mediator/scene/validate.h"
#include "mediator/wire/envelope.h"

namespace tessera::import {
namespace {

constexpr std::uint64_t MaxListBytes = 2ull << 30;  // that protobuf can parse
constexpr std::uint64_t MaxNotices = 1ull << 20, MaxBlobs = 1ull << 28;
constexpr std::uint64_t MaxNoticeBytes = 1ull << 16;

[[noreturn]] void reject_transfer(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, "its reader returned a scene that is wrong (" + cause +
                                             "): the file is damaged, export it again");
}

class Writer {
  public:
    explicit Writer(const ByteSink& sink) : sink_(sink) {}
    void number(std::uint64_t value) { sink_(std::as_bytes(std::span(&value, 1))); }
    void bytes(std::span<const std::byte> all) {
        number(all.size());
        sink_(all);
    }

  private:
    const ByteSink& sink_;
};

class Receiver {
  public:
    explicit Receiver(const ByteSource& source) : source_(source) {}
    std::uint64_t number(std::uint64_t most) {
        std::uint64_t value = 0;
        source_(std::as_writable_bytes(std::span(&value, 1)));
        if (value > most) reject_transfer("too large");
        return value;
    }
    std::vector<std::byte> bytes(std::uint64_t most) {
        constexpr std::uint64_t Piece = 16 << 20;  // memory grows with the actual bytes
        std::vector<std::byte> all;
        for (std::uint64_t left = number(most); left > 0;) {
            const std::uint64_t count = std::min(left, Piece);
            all.resize(all.size() + count);
            source_(std::span(all).last(count));
            left -= count;
        }
        return all;
    }

  private:
    const ByteSource& source_;
};

scene::Scene checked_scene(const std::vector<std::byte>& list) {
    auto snapshot = wire::decode_change_list(list);
    if (!snapshot) reject_transfer(snapshot.error().what());
    scene::Scene scene;
    if (const auto applied = scene.apply(*snapshot); !applied) reject_transfer(applied.error().what());
    if (const auto problems = scene::validate(scene); !problems.empty())
        reject_transfer(problems.front().message);
    return scene;
}

}  // namespace

void send_scene(const ImportedScene& scene, const ByteSink& sink) {
    scene::Scene complete;
    if (const auto applied = complete.apply_entries(entries(scene, RootEntry::Create)); !applied)
        throw applied.error();
    Writer writer(sink);
    writer.bytes(wire::encode(scene::snapshot(complete)));
    for (const std::uint64_t count :
         {scene.counts.triangles, scene.counts.degenerate_triangles, scene.counts.geometries,
          scene.counts.textures, scene.counts.placeholders})
        writer.number(count);
    writer.number(scene.notices.size());
    for (const std::string& notice : scene.notices)
        writer.bytes(
            std::as_bytes(std::span(notice).first(std::min<std::size_t>(notice.size(), MaxNoticeBytes))));
    writer.number(scene.blobs.size());
    for (const scene::BlobPtr& blob : scene.blobs) writer.bytes(blob->bytes());
}

void receive_scene(const ByteSource& source, SceneBuilder& builder) {
    Receiver receiver(source);
    const scene::Scene scene = checked_scene(receiver.bytes(MaxListBytes));
    ImportCounts& counts = builder.result().counts;
    for (std::uint64_t* count : {&counts.triangles, &counts.degenerate_triangles, &counts.geometries,
                                 &counts.textures, &counts.placeholders})
        *count = receiver.number(~std::uint64_t{0});
    for (std::uint64_t left = receiver.number(MaxNotices); left > 0; --left) {
        const std::vector<std::byte> text = receiver.bytes(MaxNoticeBytes);
        builder.notice({reinterpret_cast<const char*>(text.data()), text.size()});
    }
    scene::BlobStore blobs;
    for (std::uint64_t left = receiver.number(MaxBlobs); left > 0; --left) {
        const std::vector<std::byte> bytes = receiver.bytes(MaxDecodedBytes);
        if (bytes.empty()) reject_transfer("an empty array");
        builder.blob(bytes);
        blobs.insert(builder.result().blobs.back());
    }
    for (const auto& [id, object] : scene.objects()) {
        for (const scene::BlobRef& reference : scene::referenced_blobs(*object)) {
            const scene::BlobPtr blob = blobs.find(reference.hash);
            if (!blob || blob->bytes().size() != reference.byte_size) reject_transfer("an array is missing");
        }
        if (const auto problems = scene::validate_blobs(id, *object, blobs); !problems.empty())
            reject_transfer(problems.front().message);
        builder.adopt(id, *object);
    }
}

}  // namespace tessera::import
