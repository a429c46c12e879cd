#include "tests/bench/micro/scene_fixture.h"

#include "client/import/import.h"
#include "tests/support/folders.h"

namespace tessera::bench {

SceneFixture::SceneFixture(const std::string& file, std::uint32_t size) {
    auto imported = import::import_scene((test::scenes_folder() / file).string(), {});
    if (!imported) throw imported.error();
    for (const auto& blob : imported->blobs) blobs->insert(blob);
    scene::Scene scene;
    if (auto applied = scene.apply_entries(import::entries(*imported, import::RootEntry::Create)); !applied) {
        throw applied.error();
    }
    scene.set_version({1, 1});
    changes = scene::snapshot(scene);
    if (auto applied = world.apply(changes); !applied) throw applied.error();
    if (auto committed = world.commit(); !committed) throw committed.error();
    const auto& camera = imported->cameras.at(0);
    view.width = view.height = size;
    view.camera = view::perspective(camera.world_from_camera, camera.camera.vertical_fov, 1.0);
    view.channels = {frame::Channel::Radiance};
}

}  // namespace tessera::bench
