#include "tests/import/animated_file.h"

#include <glm/gtc/type_precision.hpp>
#include <glm/mat4x4.hpp>
#include <numbers>

namespace tessera::import {
namespace {

int scalars(SceneFile& file, const std::vector<float>& values) {
    return file.accessor(file.view(values), Component::Float, "SCALAR", values.size());
}

int turns(SceneFile& file, const std::vector<glm::vec4>& values) {
    return file.accessor(file.view(values), Component::Float, "VEC4", values.size());
}

void add_arm(SceneFile& file) {
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}});
    const int normal = file.positions(std::vector<glm::vec3>(4, {0, 0, 1}));
    const int joints = file.accessor(
        file.view(std::vector<glm::u8vec4>{{0, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}}),
        Component::UByte, "VEC4", 4);
    const int weights = turns(file, std::vector<glm::vec4>(4, {1, 0, 0, 0}));
    file.add("meshes", R"({"name":"arm","primitives":[{"attributes":{"POSITION":)" + std::to_string(at) +
                           R"(,"NORMAL":)" + std::to_string(normal) + R"(,"JOINTS_0":)" +
                           std::to_string(joints) + R"(,"WEIGHTS_0":)" + std::to_string(weights) +
                           R"(},"indices":)" + std::to_string(file.indices({0, 1, 2, 2, 1, 3})) + "}]}");
    glm::mat4 hand(1.0f);
    hand[3] = {0, -1, 0, 1};
    const int binds =
        file.accessor(file.view(std::vector<glm::mat4>{glm::mat4(1.0f), hand}), Component::Float, "MAT4", 2);
    file.add("skins", R"({"joints":[2,3],"inverseBindMatrices":)" + std::to_string(binds) + "}");
}

void add_face(SceneFile& file) {
    const int at = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const int difference = file.positions({{0, 0, 0}, {0, 0, 0}, {0, 0, 3}});
    file.add("meshes", R"({"name":"face","primitives":[{"attributes":{"POSITION":)" + std::to_string(at) +
                           R"(},"targets":[{"POSITION":)" + std::to_string(difference) + "}]}]}");
}

}  // namespace

std::string animation(const std::string& name, int input, int output, int node, const std::string& path,
                      const std::string& interpolation) {
    return R"({"name":")" + name + R"(","samplers":[{"input":)" + std::to_string(input) + R"(,"output":)" +
           std::to_string(output) + R"(,"interpolation":")" + interpolation +
           R"("}],"channels":[{"sampler":0,"target":{"node":)" + std::to_string(node) + R"(,"path":")" +
           path + R"("}}]})";
}

SceneFile moving_file() {
    SceneFile file;
    add_arm(file);
    add_face(file);
    file.add("cameras", R"({"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}})");
    file.add("nodes", R"({"name":"cart","children":[1,2,4]})");
    file.add("nodes", R"({"name":"body","mesh":0,"skin":0,"translation":[1000,0,0]})");
    file.add("nodes", R"({"name":"shoulder","children":[3]})");
    file.add("nodes", R"({"name":"hand","translation":[0,1,0]})");
    file.add("nodes", R"({"name":"eye","camera":0,"translation":[0,0,5]})");
    file.add("nodes", R"({"name":"face","mesh":1})");
    file.add("nodes", R"({"name":"flag","mesh":1})");
    file.add("scenes", R"({"nodes":[0,5,6]})");
    const float half = std::numbers::sqrt2_v<float> / 2;
    const int seconds = scalars(file, {0, 2});
    file.add("animations",
             animation("drive", seconds, file.positions({{0, 0, 0}, {10, 0, 0}}), 0, "translation"));
    file.add("animations", animation("wave", scalars(file, {0, 1}),
                                     turns(file, {{0, 0, 0, 1}, {0, 0, half, half}}), 3, "rotation"));
    file.add("animations",
             animation("smile", scalars(file, {0, 1, 2}), scalars(file, {0, 1, 0}), 5, "weights"));
    file.add("animations", animation("hoist", seconds, file.positions({{0, 0, 0}, {1, 1, 1}}), 6, "scale"));
    return file;
}

}  // namespace tessera::import
