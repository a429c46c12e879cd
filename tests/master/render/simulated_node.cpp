#include "tests/master/render/simulated_node.h"

#include <algorithm>

namespace tessera::master {

WorkerRate::WorkerRate(const SimulatedNodeSettings& node) {
    std::vector<double> times{0.0, node.slow_from, node.stalls_at, node.stalls_at + node.stalls_for,
                              node.dies_at};
    std::sort(times.begin(), times.end());
    for (const double time : times) {
        const bool stands =
            time >= node.dies_at || (time >= node.stalls_at && time < node.stalls_at + node.stalls_for);
        const double factor = time >= node.slow_from ? node.slow_factor : 1.0;
        if (time < SimulatedNodeSettings::Never) steps_.push_back({time, stands ? 0.0 : node.rate * factor});
    }
}

double WorkerRate::rendered(double from, double to) const {
    double samples = 0.0;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        const double end = i + 1 < steps_.size() ? steps_[i + 1].from : SimulatedNodeSettings::Never;
        samples += steps_[i].rate * std::max(0.0, std::min(to, end) - std::max(from, steps_[i].from));
    }
    return samples;
}

double WorkerRate::time_after(double start, double samples) const {
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        const double end = i + 1 < steps_.size() ? steps_[i + 1].from : SimulatedNodeSettings::Never;
        const double begin = std::max(start, steps_[i].from);
        if (begin >= end) continue;
        const double all = steps_[i].rate * (end - begin);
        if (samples <= all) return begin + (samples > 0.0 ? samples / steps_[i].rate : 0.0);
        samples -= all;
    }
    return SimulatedNodeSettings::Never;
}

void SimulatedNode::work(const Unit& unit, double now) {
    waiting_.push_back(unit);
    start_workers(now);
}

void SimulatedNode::start_workers(double now) {
    while (!waiting_.empty() && running_.size() < settings_.workers) {
        const Unit unit = waiting_.front();
        waiting_.pop_front();
        running_.push_back({unit, now});
        starts_.push_back({unit.id, rate_.time_after(now, static_cast<double>(unit.samples))});
    }
}

void SimulatedNode::finish(UnitId id, double now) {
    const auto found =
        std::ranges::find(running_, id, [](const Running& running) { return running.unit.id; });
    if (found == running_.end()) return;
    const auto [unit, start] = *found;
    running_.erase(found);
    start_workers(now);
    messages_.push_back({Message::Kind::SlotIsFree, id});
    if (settings_.fails_on.contains(unit.tile)) {
        messages_.push_back({Message::Kind::Failed, id});
    } else {
        samples_ += unit.samples;
        hold({id, unit.tile, unit.block, unit.samples, now - start, now, 1}, now);
    }
}

bool SimulatedNode::other_half_is_coming(const Film& film) const {
    const auto is_in_it = [&](const Unit& unit) {
        return unit.tile == film.tile && film.block.sibling().contains(unit.block);
    };
    return std::any_of(waiting_.begin(), waiting_.end(), is_in_it) ||
           std::any_of(running_.begin(), running_.end(),
                       [&](const Running& running) { return is_in_it(running.unit); });
}

void SimulatedNode::hold(Film film, double now) {
    for (auto half = held_.begin(); half != held_.end();) {
        if (half->tile != film.tile || half->block != film.block.sibling()) {
            ++half;
            continue;
        }
        film = {film.unit,
                film.tile,
                film.block.parent(),
                film.samples + half->samples,
                film.busy + half->busy,
                std::min(film.since, half->since),
                film.units + half->units};
        held_.erase(half);
        half = held_.begin();
    }
    held_.push_back(film);
    send_ready(now);
}

void SimulatedNode::send_ready(double now) {
    std::erase_if(held_, [&](const Film& film) {
        if (now - film.since < hold_film_ && other_half_is_coming(film)) return false;
        messages_.push_back({Message::Kind::Film, film.unit, film});
        return true;
    });
}

std::optional<double> SimulatedNode::oldest_film() const {
    std::optional<double> oldest;
    for (const Film& film : held_) oldest = std::min(oldest.value_or(film.since), film.since);
    return oldest;
}

void SimulatedNode::cancel(const Unit& cancelled, double now) {
    const UnitId id = cancelled.id;
    const auto release = [&] {
        messages_.push_back({Message::Kind::SlotIsFree, id});
        messages_.push_back({Message::Kind::Released, id});
    };
    if (std::erase_if(waiting_, [&](const Unit& unit) { return unit.id == id; }) > 0) {
        release();
    } else if (const auto running =
                   std::ranges::find(running_, id, [](const Running& entry) { return entry.unit.id; });
               running != running_.end()) {
        wasted_samples_ += rate_.rendered(running->start, now);
        running_.erase(running);
        release();
        start_workers(now);
    } else if (const auto held = std::ranges::find_if(held_,
                                                      [&](const Film& film) {
                                                          return film.tile == cancelled.tile &&
                                                                 film.block.contains(cancelled.block);
                                                      });
               held != held_.end()) {
        // The master may still need the others that it is merged with.
        if (held->units == 1) {
            wasted_samples_ += static_cast<double>(held->samples);
            messages_.push_back({Message::Kind::Released, id});
        } else {
            messages_.push_back({Message::Kind::Film, id, *held});
        }
        held_.erase(held);
    }
}

void SimulatedNode::forget_everything(double now) {
    for (const Running& running : running_) wasted_samples_ += rate_.rendered(running.start, now);
    for (const Film& film : held_) wasted_samples_ += static_cast<double>(film.samples);
    waiting_.clear();
    running_.clear();
    held_.clear();
}

}  // namespace tessera::master
