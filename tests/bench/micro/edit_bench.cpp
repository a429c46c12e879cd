// Cost of an edit on the master, in scenes of two sizes: it must not depend on the size of the scene.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <iostream>

#include "master/scene/scene_authority.h"
#include "mediator/scene/fields.h"

namespace {

using namespace tessera;
using namespace tessera::scene;

constexpr std::uint64_t GroupSize = 100;

// Groups of lights below the root, each with a sibling material; `objects` in total.
class Fixture {
  public:
    explicit Fixture(std::uint64_t objects) {
        std::vector<Entry> entries;
        Root root;
        for (std::uint64_t group = 0; group * (GroupSize + 2) < objects; ++group) {
            Transform transform{.name = "group"};
            for (std::uint64_t i = 0; i < GroupSize; ++i) {
                transform.children.push_back(next());
                entries.push_back(Create{transform.children.back(), Light{.name = "lamp"}});
            }
            groups_.push_back(next());
            entries.push_back(Create{groups_.back(), transform});
            root.children.push_back(groups_.back());
            materials_.push_back(next());
            entries.push_back(Create{materials_.back(), Material{.name = "paint"}});
        }
        entries.push_back(Update{RootId, Fields<Root>(&Root::children).bits(), root});
        submit(std::move(entries));
        authority_.publish();
    }

    void submit(std::vector<Entry> entries, std::uint64_t edit_group = 0) {
        const auto answer = authority_.submit({.session = Session,
                                               .sequence = ++sequence_,
                                               .entries = std::move(entries),
                                               .edit_group = edit_group},
                                              {"bench", "bench", static_cast<std::int64_t>(sequence_)});
        if (!answer.accepted) {
            std::cerr << answer.problems.at(0) << "\n";
            std::abort();
        }
    }

    ObjectId next() { return ObjectId{ids_.first + count_++}; }
    ObjectId group(std::uint64_t i) const { return groups_[i % groups_.size()]; }
    ObjectId material(std::uint64_t i) const { return materials_[i % materials_.size()]; }
    master::SceneAuthority& authority() { return authority_; }
    // As the live master does: a version every 16 ms at 1,000 edits per second.
    void publish_now_and_then() {
        if (sequence_ % 16 == 0) authority_.publish();
    }

  private:
    static constexpr SessionId Session{1};
    master::SceneAuthority authority_{1, std::make_shared<BlobStore>()};
    master::SceneAuthority::IdRange ids_ = authority_.allocate_id_range(Session);
    std::uint64_t count_ = 0, sequence_ = 0;
    std::vector<ObjectId> groups_, materials_;
};

void set_a_colour(benchmark::State& state) {
    Fixture fixture(static_cast<std::uint64_t>(state.range(0)));
    std::uint64_t i = 0;
    for (auto _ : state) {
        Material paint;
        paint.roughness = static_cast<float>(++i % 997) / 997.0f;
        fixture.submit({Update{fixture.material(i), Fields<Material>(&Material::roughness).bits(), paint}},
                       i / 100 + 1);
        fixture.publish_now_and_then();
    }
}

void move_a_group(benchmark::State& state) {
    Fixture fixture(static_cast<std::uint64_t>(state.range(0)));
    std::uint64_t i = 0;
    for (auto _ : state) {
        Transform moved;
        moved.matrix[3][0] = static_cast<double>(++i);
        fixture.submit({Update{fixture.group(i), Fields<Transform>(&Transform::matrix).bits(), moved}});
        fixture.publish_now_and_then();
    }
}

void add_and_remove_a_lamp(benchmark::State& state) {
    Fixture fixture(static_cast<std::uint64_t>(state.range(0)));
    std::uint64_t i = 0;
    constexpr std::uint32_t Children = Fields<Transform>(&Transform::children).bits();
    for (auto _ : state) {
        const ObjectId group = fixture.group(++i), lamp = fixture.next();
        Transform parent = *fixture.authority().scene().find_as<Transform>(group);
        parent.children.push_back(lamp);
        fixture.submit({Create{lamp, Light{.name = "new"}}, Update{group, Children, parent}});
        parent.children.pop_back();
        fixture.submit({Remove{lamp}, Update{group, Children, parent}});
        fixture.publish_now_and_then();
    }
}

BENCHMARK(set_a_colour)->Arg(1'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);
BENCHMARK(move_a_group)->Arg(1'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);
BENCHMARK(add_and_remove_a_lamp)->Arg(1'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
