#pragma once

#include <array>
#include <cstring>
#include <memory>

#include "mediator/backend/backend.h"
#include "tests/backend/scene_builder.h"

namespace tessera::test {

inline constexpr ObjectId Floor{20}, Block{21}, FloorAt{10}, BlockAt{11}, BlockAlsoAt{12}, LampAt{13},
    Lamp{30}, Red{40}, Emissive{41}, Sky{50};

template <class T>
scene::BlobRef array_blob(scene::BlobStore& store, const std::vector<T>& values) {
    return scene::reference(*store.insert(std::as_bytes(std::span(values))));
}

// A square in the xy plane around the origin; `size` is half an edge.
inline scene::Geometry square(scene::BlobStore& store, float size, ObjectId material) {
    scene::Geometry geometry;
    geometry.material = material;
    geometry.positions =
        array_blob<float>(store, {-size, -size, 0, size, -size, 0, size, size, 0, -size, size, 0});
    geometry.indices = array_blob<std::uint32_t>(store, {0, 1, 2, 0, 2, 3});
    return geometry;
}

// A wall, two instances of an emissive square in front of it, a lamp and a grey sky, seen from +z.
inline std::vector<scene::Entry> contract_scene(scene::BlobStore& store) {
    using scene::Create;
    scene::Root root;
    root.children = {FloorAt, BlockAt, BlockAlsoAt, LampAt};
    root.background = Sky;
    scene::Material red, emissive;
    red.base_color = {0.7f, 0.2f, 0.1f, 1.0f};
    emissive.emission = {2.0f, 1.5f, 1.0f};
    scene::Light lamp;
    lamp.intensity = {10.0f, 10.0f, 10.0f};
    scene::Background sky;
    sky.color = {0.2f, 0.25f, 0.3f};
    return {Create{scene::RootId, root},
            Create{FloorAt, transform(moved(0, 0, -3), {Floor})},
            Create{BlockAt, transform(moved(-0.5, 0, -2), {Block})},
            Create{BlockAlsoAt, transform(moved(0.6, 0.2, -2.5), {Block})},
            Create{LampAt, transform(moved(0, 1, 0), {Lamp})},
            Create{Floor, square(store, 1.2f, Red)},
            Create{Block, square(store, 0.3f, Emissive)},
            Create{Lamp, lamp},
            Create{Red, red},
            Create{Emissive, emissive},
            Create{Sky, sky}};
}

inline view::View contract_view(frame::ChannelSet channels) {
    view::View view;
    view.id = ViewId{1};
    view.width = 48;
    view.height = 32;
    view.window = {0, 0, 48, 32};
    view.camera.left = -0.75;
    view.camera.right = 0.75;
    view.camera.bottom = -0.5;
    view.camera.top = 0.5;
    view.seed = 7;
    view.channels = channels;
    return view;
}

inline void commit(backend::Backend& backend, const std::vector<scene::ChangeList>& lists) {
    const auto scope = backend.begin_edit();
    for (const scene::ChangeList& list : lists) {
        if (const auto done = scope->apply(list); !done) throw done.error();
    }
    if (const auto done = scope->commit(); !done) throw done.error();
}

}  // namespace tessera::test
