#include "tests/transport/device_scene.h"

#include <map>

#include "backends/vulkan/device/transfer.h"

namespace tessera::vulkan {

DeviceScene::DeviceScene(Device& device, backend::SceneTables tables) {
    std::map<scene::BlobPtr, std::uint64_t> uploaded;
    const auto keep = [&](Buffer buffer) {
        buffers_.push_back(std::move(buffer));
        return buffers_.back().address();
    };
    backend::set_addresses(tables, [&](const scene::BlobPtr& blob) {
        const auto [place, is_new] = uploaded.try_emplace(blob, 0);
        if (is_new) {
            Buffer buffer(device, blob->bytes().size());
            upload_bytes(device, buffer, blob->bytes());
            place->second = keep(std::move(buffer));
        }
        return place->second;
    });
    record_ = tables.scene;
    const auto put = [&](auto& array, const auto& values) {
        array.items = reinterpret_cast<decltype(array.items)>(keep(make_buffer(device, values)));
    };
    put(record_.textures, tables.textures);
    put(record_.materials, tables.materials);
    put(record_.extras, tables.extras);
    put(record_.surface_shaders, tables.surface_shaders);
    put(record_.meshes, tables.meshes);
    put(record_.media, tables.media);
    put(record_.instances, tables.instances);
    put(record_.lights, tables.lights);
    put(record_.emitters, tables.emitters);
    put(record_.light_nodes, tables.light_nodes);
    put(record_.cdfs, tables.cdfs);
    const auto srgb = backend::srgb_values();
    put(record_.srgb, std::vector<float>(srgb.begin(), srgb.end()));
    const auto energy = backend::energy_values();
    put(record_.energy, std::vector<float>(energy.begin(), energy.end()));
}

}  // namespace tessera::vulkan
