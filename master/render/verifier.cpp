#include "master/render/verifier.h"

#include <algorithm>
#include <utility>

namespace tessera::master {

bool Verifier::chooses_next() {
    return is_on() && waiting_.size() + held_.size() < MaxTasks && random_.uniform() < settings_.share;
}

void Verifier::add(Task task, const Witness& first) {
    task.asked.insert(first.node);
    task.witnesses.push_back(first);
    waiting_.push_back(std::move(task));
}

void Verifier::follow(ViewId view, Version version) {
    for (Task& task : waiting_) {
        if (task.view->id == view) task.version = version;
    }
}

std::vector<Cancellation> Verifier::forget(ViewId view) {
    std::vector<Cancellation> cancellations;
    std::erase_if(waiting_, [&](const Task& task) { return task.view->id == view; });
    std::erase_if(held_, [&](const auto& entry) {
        if (entry.second.task.view->id != view) return false;
        cancellations.push_back({entry.second.node, entry.first});
        return true;
    });
    return cancellations;
}

void Verifier::drop_old(TimePoint now) {
    std::erase_if(waiting_, [&](const Task& task) { return now - task.since > settings_.patience; });
}

bool Verifier::uses(ViewId view) const {
    return std::ranges::any_of(waiting_, [&](const Task& task) { return task.view->id == view; }) ||
           std::ranges::any_of(held_, [&](const auto& entry) { return entry.second.task.view->id == view; });
}

std::optional<Verifier::Dealt> Verifier::deal(NodeId node, const std::function<bool(const Task&)>& may) {
    const auto has_one_of_tile = [&](const Task& task) {
        return std::ranges::any_of(held_, [&](const auto& entry) {
            const Held& held = entry.second;
            return held.node == node && held.task.view->id == task.view->id && held.task.tile == task.tile;
        });
    };
    const auto task = std::ranges::find_if(waiting_, [&](const Task& waiting) {
        return !waiting.asked.contains(node) && may(waiting) && !has_one_of_tile(waiting);
    });
    if (task == waiting_.end()) return std::nullopt;
    task->asked.insert(node);
    const Dealt dealt{.unit = {.id = UnitId{next_unit_++},
                               .view = task->view->id,
                               .revision = task->view->revision,
                               .version = task->version,
                               .tile = task->tile,
                               .block = task->block},
                      .view = task->view};
    held_.emplace(dealt.unit.id, Held{node, std::move(*task)});
    waiting_.erase(task);
    return dealt;
}

const Verifier::Task* Verifier::held(UnitId unit, NodeId node) const {
    const auto entry = held_.find(unit);
    return entry == held_.end() || entry->second.node != node ? nullptr : &entry->second.task;
}

std::vector<UnitId> Verifier::held_by(NodeId node) const {
    std::vector<UnitId> units;
    for (const auto& [unit, task] : tasks_of(node)) units.push_back(unit);
    return units;
}

std::vector<std::pair<UnitId, const Verifier::Task*>> Verifier::tasks_of(NodeId node) const {
    std::vector<std::pair<UnitId, const Task*>> tasks;
    for (const auto& [unit, held] : held_) {
        if (held.node == node) tasks.emplace_back(unit, &held.task);
    }
    return tasks;
}

std::optional<Verifier::Finding> Verifier::take(UnitId unit, const Witness& witness) {
    if (held(unit, witness.node) == nullptr) return std::nullopt;
    Task task = std::move(held_.extract(unit).mapped().task);
    task.witnesses.push_back(witness);
    const std::vector<Witness>& all = task.witnesses;
    Finding finding;
    if (all.size() == 2) {
        finding.outcome = all[0].film == all[1].film ? Outcome::Agreed : Outcome::Differs;
        if (finding.outcome == Outcome::Differs) waiting_.push_front(task);
    } else if (all[2].film == all[0].film || all[2].film == all[1].film) {
        finding.outcome = Outcome::OneIsOdd;
        finding.odd = all[2].film == all[0].film ? all[1] : all[0];
    } else {
        finding.outcome = Outcome::AllDiffer;
    }
    finding.task = std::move(task);
    return finding;
}

bool Verifier::end(UnitId unit, NodeId node) {
    if (held(unit, node) == nullptr) return false;
    waiting_.push_back(std::move(held_.extract(unit).mapped().task));
    return true;
}

void Verifier::node_gone(NodeId node) {
    for (const UnitId unit : held_by(node)) end(unit, node);
}

}  // namespace tessera::master
