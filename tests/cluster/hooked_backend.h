#pragma once

#include <functional>

#include "mediator/backend/catalog.h"
#include "tests/cluster/loopback_cluster.h"

namespace tessera::test {

// A null back-end whose results a test may spoil.
class HookedBackend final : public backend::Backend {
  public:
    using Hook = std::function<void(const view::WorkUnit& unit, backend::RenderResult& result)>;

    // `kind` "" = that of the null back-end.
    HookedBackend(std::unique_ptr<Backend> inner, Hook hook, std::string kind)
        : inner_(std::move(inner)), hook_(std::move(hook)), kind_(std::move(kind)) {}

    backend::Capabilities capabilities() const override {
        backend::Capabilities capabilities = inner_->capabilities();
        if (!kind_.empty()) capabilities.kind = kind_;
        return capabilities;
    }
    Version version() const override { return inner_->version(); }
    std::unique_ptr<backend::EditScope> begin_edit() override { return inner_->begin_edit(); }
    backend::RenderResult render(const view::View& view, const view::WorkUnit& unit,
                                 std::stop_token stop) override {
        backend::RenderResult result = inner_->render(view, unit, stop);
        hook_(unit, result);
        return result;
    }
    std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                   std::uint64_t sample) override {
        return inner_->probe(view, x, y, sample);
    }

  private:
    std::unique_ptr<Backend> inner_;
    Hook hook_;
    std::string kind_;
};

inline LoopbackCluster::MakeBackend hooked(HookedBackend::Hook hook, Duration cost = {},
                                           const std::string& kind = {}) {
    return [hook = std::move(hook), cost, kind](const backend::BackendSettings& settings) {
        backend::BackendSettings own = settings;
        own.simulated_sample_cost = cost;
        return std::make_unique<HookedBackend>(backend::find_backend("null").make(own), hook, kind);
    };
}

}  // namespace tessera::test
