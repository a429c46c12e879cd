#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "mediator/backend/catalog.h"
#include "tests/contract/contract_scene.h"

namespace tessera::backend {

// One back-end of the catalog, by name, with the contract's scene and a view of all its channels.
struct BackendContract : testing::TestWithParam<std::string> {
    BackendContract() : backend(fresh()) {
        test::commit(*backend, {builder.edit(test::contract_scene(*blobs))});
        view = test::contract_view(backend->capabilities().channels);
    }

    // Of all back-ends of this build.
    static std::vector<std::string> names() {
        std::vector<std::string> result;
        for (const BackendEntry& entry : catalog()) result.push_back(entry.name);
        return result;
    }

    std::unique_ptr<Backend> fresh() const {
        return find_backend(GetParam()).make({.threads = 2, .isa = {}, .blobs = blobs});
    }

    view::WorkUnit unit(Rect tile, frame::SampleBlock block) const {
        return {.id = UnitId{1},
                .view = view.id,
                .revision = view.revision,
                .version = backend->version(),
                .tile = tile,
                .block = block};
    }

    frame::FilmTile render(Backend& with, Rect tile, frame::SampleBlock block) const {
        view::WorkUnit work = unit(tile, block);
        work.version = with.version();
        RenderResult result = with.render(view, work, {});
        EXPECT_EQ(result.status, RenderStatus::Done);
        EXPECT_EQ(result.blocks.size(), 1u);
        EXPECT_EQ(result.blocks.at(0).block, block);
        return std::move(result.blocks.at(0));
    }

    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    test::SceneBuilder builder;
    std::unique_ptr<Backend> backend;
    view::View view;
    Rect whole{0, 0, 48, 32};
};

}  // namespace tessera::backend
