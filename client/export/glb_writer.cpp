#include <tiny_gltf.h>

#include <ostream>
#include <set>
#include <streambuf>

#include "client/export/durable_file.h"
#include "client/export/export.h"
#include "client/export/glb_nodes.h"

namespace tessera::exporting {
namespace {

// Stream buffer that writes to a sink. Streams swallow exceptions of their buffer, so the first one is kept.
class SinkBuffer : public std::streambuf {
  public:
    explicit SinkBuffer(const Sink& sink) : sink_(sink) {}
    void finish() const {
        if (error_) throw *error_;
    }

  private:
    std::streamsize xsputn(const char* bytes, std::streamsize count) override {
        if (error_) return 0;
        try {
            sink_(std::as_bytes(std::span(bytes, static_cast<std::size_t>(count))));
            return count;
        } catch (const Error& error) {
            error_ = error;
            return 0;
        }
    }
    int_type overflow(int_type value) override {
        const char byte = traits_type::to_char_type(value);
        return xsputn(&byte, 1) == 1 ? value : traits_type::eof();
    }

    const Sink& sink_;
    std::optional<Error> error_;
};

void report_omissions(const scene::Scene& scene, std::set<std::string>& notices) {
    const std::string remedy = "; save the scene as .tessera to keep it";
    const auto& root = *scene.find_as<scene::Root>(scene::RootId);
    const auto* background = scene.find_as<scene::Background>(root.background);
    if (background && (background->environment || background->color != glm::vec3(0.0f))) {
        notices.insert("the background is left out: glTF has no backgrounds" + remedy);
    }
    std::size_t attachments = 0, moving = 0;
    for (const auto& [id, object] : scene.objects()) {
        attachments += std::holds_alternative<scene::Attachment>(*object) ? 1 : 0;
        const auto* transform = std::get_if<scene::Transform>(object.get());
        const auto* geometry = std::get_if<scene::Geometry>(object.get());
        if (transform && !transform->motion.empty()) ++moving;
        if (geometry && !geometry->motion_positions.empty()) ++moving;
    }
    if (attachments > 0) notices.insert("attachments are left out: " + std::to_string(attachments) + remedy);
    if (moving > 0) {
        notices.insert("motion keys (motion blur) are left out, objects: " + std::to_string(moving) + remedy);
    }
}

void write(const scene::Scene& scene, const scene::BlobStore& blobs, const std::filesystem::path& file,
           std::set<std::string>& notices) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "tessera";
    tinygltf::Scene top;
    top.nodes =
        GlbNodes(model, scene, blobs, notices).build(scene.find_as<scene::Root>(scene::RootId)->children);
    model.scenes.push_back(std::move(top));
    model.defaultScene = 0;
    report_omissions(scene, notices);
    write_durably(file, [&](const Sink& sink) {
        SinkBuffer buffer(sink);
        std::ostream stream(&buffer);
        tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true);
        buffer.finish();
    });
}

}  // namespace

Expected<Notices> write_glb(const scene::Scene& scene, const scene::BlobStore& blobs,
                            const std::filesystem::path& file) {
    if (const auto* root = scene.find_as<scene::Root>(scene::RootId); root == nullptr) {
        return failure(ErrorCode::InvalidInput, "the scene has no root: there is nothing to save");
    }
    std::set<std::string> notices;
    try {
        write(scene, blobs, file, notices);
    } catch (const Error& error) {
        return tl::unexpected<Error>(error);
    }
    return Notices(notices.begin(), notices.end());
}

}  // namespace tessera::exporting
