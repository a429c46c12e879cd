#include "tests/import/inspect.h"

#include <cmath>
#include <map>
#include <set>

#include "mediator/scene/fields.h"
#include "mediator/scene/validate.h"

namespace tessera::import {
namespace {

class Soundness {
  public:
    explicit Soundness(const ImportedScene& scene, const ImportOptions& options) : scene_(scene) {
        for (const scene::BlobPtr& blob : scene.blobs) blobs_[blob->hash()] = blob->bytes().size();
        EXPECT_EQ(blobs_.size(), scene.blobs.size());
        std::uint64_t next = options.first_id.value;
        for (const scene::Create& create : scene.objects) {
            EXPECT_EQ(create.id.value, next++);
            const std::string name = std::visit([](const auto& value) { return value.name; }, create.object);
            EXPECT_FALSE(name.empty());
            EXPECT_TRUE(names_.emplace(create.object.index(), name).second) << name << " exists twice";
            kinds_[create.id] = scene::kind(create.object);
        }
    }

    void check() {
        for (const scene::Create& create : scene_.objects) {
            std::visit([&](const auto& value) { object(value); }, create.object);
        }
        object(scene_.root);
        EXPECT_FALSE(scene_.cameras.empty());
        EXPECT_GT(scene_.counts.triangles, 0u);
        EXPECT_GT(scene_.counts.instances, 0u);
        EXPECT_EQ(used_.size(), blobs_.size()) << "some blobs are unreferenced";
    }

  private:
    void reference(ObjectId id, std::set<scene::ObjectKind> allowed) {
        if (!id) return;
        ASSERT_TRUE(kinds_.contains(id)) << id.value;
        EXPECT_TRUE(allowed.contains(kinds_[id])) << id.value;
    }
    void blob(const scene::BlobRef& wanted, std::uint64_t byte_size) {
        if (wanted.empty()) return;
        used_.insert(wanted.hash);
        ASSERT_TRUE(blobs_.contains(wanted.hash));
        EXPECT_EQ(blobs_[wanted.hash], wanted.byte_size);
        EXPECT_EQ(wanted.byte_size, byte_size);
    }
    void children(const std::vector<ObjectId>& ids) {
        using Kind = scene::ObjectKind;
        for (const ObjectId id : ids)
            reference(id, {Kind::Transform, Kind::Geometry, Kind::Light, Kind::Camera});
    }
    void object(const scene::Root& root) {
        children(root.children);
        ASSERT_TRUE(root.background);
        reference(root.background, {scene::ObjectKind::Background});
    }
    void object(const scene::Transform& transform) {
        children(transform.children);
        for (int i = 0; i < 16; ++i) EXPECT_TRUE(std::isfinite(transform.matrix[i / 4][i % 4]));
        for (const glm::dmat4& step : transform.motion) {
            for (int i = 0; i < 16; ++i) EXPECT_TRUE(std::isfinite(step[i / 4][i % 4]));
        }
    }
    void object(const scene::Geometry& geometry) {
        reference(geometry.material, {scene::ObjectKind::Material, scene::ObjectKind::SurfaceShader});
        reference(geometry.medium, {scene::ObjectKind::Medium});
        const auto indices = values<std::uint32_t>(scene_, geometry.indices);
        const std::uint64_t vertices = geometry.positions.byte_size / 12;
        ASSERT_FALSE(indices.empty());
        EXPECT_EQ(indices.size() % 3, 0u);
        blob(geometry.indices, indices.size() * 4);
        EXPECT_LT(*std::max_element(indices.begin(), indices.end()), vertices);
        blob(geometry.positions, vertices * 12);
        blob(geometry.normals, vertices * 12);
        blob(geometry.tangents, vertices * 16);
        blob(geometry.tex_coords, vertices * 8);
        blob(geometry.tex_coords_1, vertices * 8);
        blob(geometry.colors, vertices * 16);
        for (const auto* steps : {&geometry.motion_positions, &geometry.motion_normals}) {
            for (const scene::BlobRef& step : *steps) {
                blob(step, vertices * 12);
                for (const float value : values<float>(scene_, step)) ASSERT_TRUE(std::isfinite(value));
            }
        }
        for (const auto* array :
             {&geometry.positions, &geometry.normals, &geometry.tangents, &geometry.tex_coords}) {
            for (const float value : values<float>(scene_, *array)) ASSERT_TRUE(std::isfinite(value));
        }
    }
    void object(const scene::Material& material) {
        textures_of(material);
        EXPECT_TRUE(material.metallic >= 0.0f && material.metallic <= 1.0f);
        EXPECT_TRUE(material.roughness >= 0.0f && material.roughness <= 1.0f);
        for (int i = 0; i < 3; ++i)
            EXPECT_TRUE(material.emission[i] >= 0.0f && std::isfinite(material.emission[i]));
    }
    void object(const scene::SurfaceShader& shader) { textures_of(shader); }
    void object(const scene::Medium& medium) { textures_of(medium); }
    template <class T>
    void textures_of(const T& made_of) {
        scene::for_each_field<T>([&](unsigned, auto member) {
            if constexpr (std::is_same_v<decltype(member), scene::TextureSlot T::*>)
                reference((made_of.*member).texture, {scene::ObjectKind::Texture});
        });
    }
    void object(const scene::Texture& texture) {
        const std::uint64_t bytes = texture.format == scene::TexelFormat::RgbFloat ? 12 : 4;
        EXPECT_GT(texture.width, 0u);
        blob(texture.texels, std::uint64_t{texture.width} * texture.height * texture.depth * bytes);
    }
    void object(const scene::Light&) {}
    void object(const scene::Camera& camera) { EXPECT_GT(camera.vertical_fov, 0.0); }
    void object(const scene::Background& background) {
        reference(background.environment, {scene::ObjectKind::Texture});
    }
    void object(const scene::Attachment&) {}

    const ImportedScene& scene_;
    std::map<Hash256, std::uint64_t> blobs_;
    std::set<std::pair<std::size_t, std::string>> names_;
    std::map<ObjectId, scene::ObjectKind> kinds_;
    std::set<Hash256> used_;
};

}  // namespace

void expect_consistent(const ImportedScene& scene, const ImportOptions& options) {
    Soundness(scene, options).check();
}

void expect_valid(const ImportedScene& imported) {
    scene::Scene scene;
    ASSERT_TRUE(scene.apply_entries(entries(imported, RootEntry::Create)));
    scene::BlobStore blobs;
    for (const scene::BlobPtr& blob : imported.blobs) blobs.insert(blob);
    for (const scene::Problem& problem : scene::validate(scene)) ADD_FAILURE() << problem.message;
    for (const auto& [id, object] : scene.objects()) {
        for (const scene::Problem& problem : scene::validate_blobs(id, *object, blobs)) {
            ADD_FAILURE() << problem.message;
        }
    }
}

}  // namespace tessera::import
