#include "master/scene/scene_encoder.h"

#include "mediator/wire/envelope.h"

namespace tessera::master {

std::uint64_t SceneEncoder::encode(Version from, Version to, std::function<scene::ChangeList()> make) {
    const std::uint64_t job = ++jobs_;
    thread_.post([this, job, from, to, make = std::move(make)] {
        EncodedScene made{.job = job, .from = from, .to = to, .blob = nullptr};
        try {
            made.blob = std::make_shared<const scene::Blob>(std::span<const std::byte>(wire::encode(make())));
        } catch (const std::exception&) {
            made.blob = nullptr;
        }
        deliver_(std::move(made));
    });
    return job;
}

}  // namespace tessera::master
