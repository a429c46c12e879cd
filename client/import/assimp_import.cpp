#include "client/import/assimp_import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <array>
#include <assimp/Importer.hpp>
#include <map>
#include <new>

#include "client/import/assimp_files.h"
#include "client/import/assimp_materials.h"
#include "client/import/limited_process.h"
#include "client/import/limits.h"
#include "client/import/scene_transfer.h"

namespace tessera::import {
namespace {

template <class To, class From>
To vector(const From& from) {
    To to;
    for (unsigned i = 0; i < static_cast<unsigned>(To::length()); ++i) to[static_cast<int>(i)] = from[i];
    return to;
}

MeshData mesh_data(const aiMesh& source) {
    MeshData mesh;
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
        mesh.positions.push_back(vector<glm::vec3>(source.mVertices[i]));
        if (source.HasNormals()) mesh.normals.push_back(vector<glm::vec3>(source.mNormals[i]));
        if (source.HasTextureCoords(0))
            mesh.tex_coords.push_back(vector<glm::vec2>(source.mTextureCoords[0][i]));
        if (source.HasVertexColors(0)) mesh.colors.push_back(vector<glm::vec4>(source.mColors[0][i]));
    }
    for (unsigned i = 0; i < source.mNumFaces; ++i) {
        const aiFace& face = source.mFaces[i];
        if (face.mNumIndices == 3) mesh.indices.insert(mesh.indices.end(), face.mIndices, face.mIndices + 3);
    }
    return mesh;
}

class AssimpScene {
  public:
    AssimpScene(const aiScene& source, const LocalFolder& folder, SceneBuilder& builder)
        : source_(source), builder_(builder), materials_(source, folder, builder) {}

    void build() {
        struct Visit {
            const aiNode* node;
            ObjectId parent;
            std::size_t depth;
        };
        std::map<ObjectId, std::vector<ObjectId>> children;  // of each transform; 0 = the root
        std::vector<Visit> stack{{source_.mRootNode, {}, 1}};
        while (!stack.empty()) {
            const Visit visit = stack.back();
            stack.pop_back();
            if (visit.depth > MaxNesting) {
                builder_.notice("nodes nested more than " + std::to_string(MaxNesting) +
                                " deep are not drawn");
                continue;
            }
            scene::Transform transform;
            transform.name = visit.node->mName.C_Str();
            for (unsigned row = 0; row < 4; ++row) {
                for (unsigned column = 0; column < 4; ++column) {
                    transform.matrix[static_cast<int>(column)][static_cast<int>(row)] =
                        static_cast<double>(visit.node->mTransformation[row][column]);
                }
            }
            const ObjectId id = builder_.add(std::move(transform));
            children[visit.parent].push_back(id);
            for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
                if (const ObjectId mesh = geometry(visit.node->mMeshes[i])) children[id].push_back(mesh);
            }
            for (unsigned i = visit.node->mNumChildren; i > 0; --i) {
                stack.push_back({visit.node->mChildren[i - 1], id, visit.depth + 1});
            }
        }
        for (auto& [id, ids] : children) {
            (id ? builder_.get<scene::Transform>(id).children : builder_.result().root.children) =
                std::move(ids);
        }
    }

  private:
    ObjectId geometry(unsigned index) {
        const auto [entry, is_new] = geometries_.try_emplace(index);
        if (!is_new || index >= source_.mNumMeshes) return entry->second;
        const aiMesh& mesh = *source_.mMeshes[index];
        std::string name = mesh.mName.C_Str();
        if (name.empty()) name = "mesh " + std::to_string(index);
        if (!(mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) {
            builder_.notice("mesh '" + name + "': points and lines are not drawn");
            return {};
        }
        MeshData data = mesh_data(mesh);
        try {
            for (const std::string& repair : check_and_repair(data)) {
                builder_.notice("mesh '" + name + "': " + repair);
            }
            entry->second = builder_.add_geometry(name, materials_.material(mesh), data);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::InvalidInput) throw;
            builder_.notice("mesh '" + name + "' is invalid (" + error.what() +
                            "): a magenta box replaces it");
            entry->second = builder_.placeholder_geometry();
        }
        return entry->second;
    }

    const aiScene& source_;
    SceneBuilder& builder_;
    AssimpMaterials materials_;
    std::map<unsigned, ObjectId> geometries_;
};

}  // namespace

bool is_assimp_extension(std::string_view extension) {
    constexpr std::array<std::string_view, 2> Known{".obj", ".stl"};
    return std::find(Known.begin(), Known.end(), extension) != Known.end();
}

namespace {

// A file of 129 MiB takes 22 s and 1.3 GB. The other gigabytes and seconds are for its textures, which are limited by
// MaxDecodedBytes.
ProcessLimits limits_of_reader(const std::filesystem::path& file) {
    std::error_code ignored;
    const std::uintmax_t size =
        std::min<std::uintmax_t>(std::filesystem::file_size(file, ignored), MaxFileBytes);
    const auto mebibytes = static_cast<std::int64_t>(size >> 20);
    return {.memory = (4ull << 30) + MaxDecodedBytes + 64 * size,
            .processor_time = std::chrono::seconds(120 + 2 * mebibytes),
            .wall_time = std::chrono::seconds(480 + 8 * mebibytes)};
}

}  // namespace

void read_with_assimp(const std::filesystem::path& file, SceneBuilder& builder) {
    Assimp::Importer importer;
    importer.SetIOHandler(new AssimpFiles(file));  // owned by the importer
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 45.0f);
    // Texture coordinates have v up in the file and v down here.
    const aiScene* scene = importer.ReadFile(
        file.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType |
                           aiProcess_GenSmoothNormals | aiProcess_FlipUVs);
    if (!scene || !scene->mRootNode) {
        const std::string cause = importer.GetErrorString();
        if (cause.find("bad_alloc") != cause.npos) throw std::bad_alloc();
        throw Error(ErrorCode::InvalidInput,
                    "it cannot be read (" + cause.substr(0, 300) + "): export it again");
    }
    const LocalFolder folder(file);
    AssimpScene(*scene, folder, builder).build();
}

void import_with_assimp(const std::filesystem::path& file, SceneBuilder& builder) {
    run_limited(
        limits_of_reader(file),
        [&](const ByteSink& sink) {
            SceneBuilder there(builder.options());
            read_with_assimp(file, there);
            send_scene(there.result(), sink);
        },
        [&](const ByteSource& source) { receive_scene(source, builder); });
}

}  // namespace tessera::import
