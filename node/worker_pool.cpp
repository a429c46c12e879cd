#include "node/worker_pool.h"

#include <exception>

namespace tessera::node {

namespace {

std::string replay_text(const view::View& view, const view::WorkUnit& unit, const char* reason) {
    return "unit " + std::to_string(unit.id.value) + " failed: " + reason +
           "; replay it with: tessera probe SCENE --pixel " + std::to_string(unit.tile.x) + "," +
           std::to_string(unit.tile.y) + " --sample " + std::to_string(unit.block.first) + " --seed " +
           std::to_string(view.seed);
}

}  // namespace

WorkerPool::WorkerPool(backend::Backend& backend, const Clock& clock, std::uint32_t workers, Done done)
    : backend_(backend), clock_(clock), done_(std::move(done)) {
    for (std::uint32_t i = 0; i < workers; ++i) {
        threads_.emplace_back([this](std::stop_token end) { work(end); });
    }
}

WorkerPool::~WorkerPool() {
    for (std::jthread& thread : threads_) thread.request_stop();
    {
        const std::scoped_lock lock(mutex_);
        waiting_.clear();
        for (auto& [unit, stop] : stops_) stop.request_stop();
    }
    threads_.clear();
}

void WorkerPool::start(const view::View& view, const view::WorkUnit& unit) {
    {
        const std::scoped_lock lock(mutex_);
        Job job{view, unit, {}};
        stops_.insert_or_assign(unit.id, job.stop);
        waiting_.push_back(std::move(job));
    }
    wake_.notify_one();
}

void WorkerPool::stop(UnitId unit) {
    const std::scoped_lock lock(mutex_);
    if (const auto place = stops_.find(unit); place != stops_.end()) place->second.request_stop();
}

void WorkerPool::work(std::stop_token end) {
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, end, [this] { return !waiting_.empty(); })) {
        const Job job = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        UnitOutcome outcome = render(job);
        lock.lock();
        stops_.erase(job.unit.id);
        lock.unlock();
        done_(job.unit.id, std::move(outcome));
        lock.lock();
    }
}

UnitOutcome WorkerPool::render(const Job& job) {
    UnitOutcome outcome;
    const TimePoint start = clock_.now();
    try {
        outcome.result = backend_.render(job.view, job.unit, job.stop.get_token());
    } catch (const std::exception& error) {
        outcome.error = replay_text(job.view, job.unit, error.what());
    }
    outcome.busy = clock_.now() - start;
    return outcome;
}

}  // namespace tessera::node
