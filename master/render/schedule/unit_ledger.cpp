#include "master/render/schedule/unit_ledger.h"

#include <algorithm>

namespace tessera::master {

using frame::SampleBlock;

namespace {

constexpr std::size_t MaxFormer = 4096;  // units of which film is still admitted after their end

void count(session::UnitCounts& counts, Fate fate) {
    switch (fate) {
        case Fate::Merged:
            ++counts.merged;
            return;
        case Fate::Duplicate:
            ++counts.duplicate;
            return;
        case Fate::Cancelled:
            ++counts.cancelled;
            return;
        case Fate::Refused:
            ++counts.refused;
            return;
        case Fate::Lost:
            ++counts.lost;
            return;
    }
}

bool intersect(const SampleBlock& a, const SampleBlock& b) {
    return a.contains(b) || b.contains(a);
}

bool holds_or_held(const UnitLedger::Unit& unit, NodeId node) {
    return unit.holders.contains(node) ||
           std::find(unit.past_holders.begin(), unit.past_holders.end(), node) != unit.past_holders.end();
}

}  // namespace

UnitLedger::UnitLedger(std::vector<Rect> tiles, UnitId first_unit, std::size_t max_crashes)
    : tiles_(std::move(tiles)),
      first_unit_(first_unit),
      max_crashes_(max_crashes),
      open_of_tile_(tiles_.size()),
      former_of_tile_(tiles_.size()),
      arrived_(tiles_.size()),
      has_samples_(tiles_.size(), false),
      tiles_without_samples_(static_cast<std::uint32_t>(tiles_.size())) {}

// ---- dealing ----

void UnitLedger::hold(UnitId id, Unit& unit, NodeId node, TimePoint now) {
    unit.holders.emplace(node, now);
    Held& held = by_node_[node];
    held.units.insert(id);
    held.samples += unit.unit.pixel_samples();
    ++in_flight_;
}

void UnitLedger::deal(const view::WorkUnit& unit, std::uint32_t tile,
                      std::shared_ptr<const UnitTrouble> trouble, NodeId node, TimePoint now) {
    dealt_.push_back({node, tile});
    Unit& entry = open_[unit.id];
    entry.unit = unit;
    entry.tile = tile;
    entry.trouble = std::move(trouble);
    open_of_tile_[tile].push_back(unit.id);
    ++uncovered_;
    hold(unit.id, entry, node, now);
}

void UnitLedger::deal_again(UnitId unit, NodeId node, TimePoint now) {
    const auto entry = open_.find(unit);
    if (entry == open_.end()) return;
    dealt_again_[unit].insert(node);
    hold(unit, entry->second, node, now);
}

bool UnitLedger::was_dealt_to(NodeId node, UnitId unit) const {
    if (unit.value < first_unit_.value || unit.value - first_unit_.value >= dealt_.size()) return false;
    if (dealt_[unit.value - first_unit_.value].node == node) return true;
    const auto again = dealt_again_.find(unit);
    return again != dealt_again_.end() && again->second.contains(node);
}

// ---- film ----

template <class Visit>
void UnitLedger::for_each_of(NodeId node, std::uint32_t tile, const Visit& visit) {
    for (const UnitId id : open_of_tile_[tile]) {
        if (Unit& unit = open_.at(id); holds_or_held(unit, node)) visit(unit);
    }
    for (const UnitId id : former_of_tile_[tile]) {
        if (Unit& unit = former_.at(id); holds_or_held(unit, node)) visit(unit);
    }
}

void UnitLedger::begin_step() {
    arrived_.assign(tiles_.size(), {});
    step_begin_ = next_unit();
}

// How many pixels of the tile get these samples.
std::size_t UnitLedger::pixel_count(std::uint32_t tile, const SampleBlock& block) const {
    const auto has_part = [&](UnitId id, const Unit& unit) {
        return id >= step_begin_ && intersect(unit.unit.block, block);
    };
    for (const UnitId id : open_of_tile_[tile]) {
        if (const Unit& unit = open_.at(id); has_part(id, unit)) return unit.unit.pixel_count();
    }
    for (const UnitId id : former_of_tile_[tile]) {
        if (const Unit& unit = former_.at(id); has_part(id, unit)) return unit.unit.pixel_count();
    }
    return tiles_[tile].pixel_count();
}

Admission UnitLedger::admit(NodeId node, const ArrivingFilm& film) {
    if (!was_dealt_to(node, film.unit))
        return {.problem = "film of a unit that was not dealt to it", .replaceable = {}};
    const std::uint32_t tile = dealt_[film.unit.value - first_unit_.value].tile;
    if (film.rect != tiles_[tile])
        return {.problem = "film of another tile than that of its unit", .replaceable = {}};
    Admission admission{.problem = {}, .tile = tile, .replaceable = {}};
    if (film.unit < step_begin_) {
        admission.use = Admission::Use::Drop;  // late
        return admission;
    }
    if (arrived_[tile].covers(film.block)) return admission;  // late; it is compared with what is there
    BlockSet held;
    for_each_of(node, tile, [&](Unit& unit) {
        if (unit.unit.version == film.version && unit.unit.mask == film.mask) held.insert(unit.unit.block);
    });
    if (!held.covers(film.block)) {
        admission.problem =
            "film of samples or pixels, or of a version of the scene, that were not dealt to it";
        return admission;
    }
    for_each_of(node, tile, [&](Unit& unit) {
        if (!intersect(unit.unit.block, film.block)) return;
        for (const SampleBlock& part : unit.parts.blocks()) admission.replaceable.insert(part);
        unit.parts.insert(film.block.contains(unit.unit.block) ? unit.unit.block : film.block);
    });
    return admission;
}

std::vector<Cancellation> UnitLedger::arrived(NodeId node, std::uint32_t tile, const SampleBlock& block) {
    std::vector<Cancellation> cancellations;
    BlockSet& there = arrived_.at(tile);
    const std::uint64_t before = there.sample_count();
    const std::size_t pixels = pixel_count(tile, block);
    there.insert(block);
    if (!has_samples_[tile]) --tiles_without_samples_;
    has_samples_[tile] = true;
    arrived_samples_ += (there.sample_count() - before) * pixels;
    const std::vector<UnitId> units = open_of_tile_[tile];
    for (const UnitId id : units) {
        const auto entry = open_.find(id);
        Unit& unit = entry->second;
        const bool was_covered = unit.is_covered;
        if (!was_covered && there.covers(unit.unit.block)) {
            unit.is_covered = true;
            --uncovered_;
            if (unit.trouble) explain(unit.trouble, true);
            for (const auto& [holder, since] : unit.holders) {
                if (holder != node) cancellations.push_back({holder, id});
            }
            close(entry, node, Fate::Merged);
        } else if (was_covered && block.contains(unit.unit.block)) {
            close(entry, node, Fate::Duplicate);
        }
    }
    forget_former(tile);
    return cancellations;
}

// ---- ends ----

// Does nothing if the node does not hold the unit, except that a unit without holders ends.
void UnitLedger::close(std::map<UnitId, Unit>::iterator entry, NodeId node, Fate fate) {
    Unit& unit = entry->second;
    const UnitId id = entry->first;
    if (unit.holders.erase(node) > 0) {
        count(counts_, fate);
        Held& held = by_node_[node];
        held.units.erase(id);
        held.samples -= unit.unit.pixel_samples();
        --in_flight_;
        unit.past_holders.push_back(node);
        if (observer_) observer_(unit.unit, node, fate);
    }
    if (!unit.holders.empty()) return;
    std::erase(open_of_tile_[unit.tile], id);
    if (!unit.is_covered) {
        --uncovered_;
        for (const SampleBlock& gap : arrived_[unit.tile].missing_in(unit.unit.block))
            returned_.push_back({unit.tile, gap, unit.trouble});
        former_of_tile_[unit.tile].push_back(id);
        former_.emplace(id, std::move(unit));
        if (former_.size() > MaxFormer) {
            std::erase(former_of_tile_[former_.begin()->second.tile], former_.begin()->first);
            former_.erase(former_.begin());
        }
    }
    open_.erase(entry);
}

void UnitLedger::forget_former(std::uint32_t tile) {
    std::erase_if(former_of_tile_[tile], [&](UnitId id) {
        const auto former = former_.find(id);
        if (!arrived_[tile].covers(former->second.unit.block)) return false;
        former_.erase(former);
        return true;
    });
}

bool UnitLedger::end(UnitId unit, NodeId node, Fate fate) {
    const auto entry = open_.find(unit);
    if (entry == open_.end() || !entry->second.holders.contains(node)) return false;
    close(entry, node, fate);
    return true;
}

void UnitLedger::end_film(NodeId node, std::uint32_t tile, const SampleBlock& block, Fate fate) {
    const std::vector<UnitId> units = open_of_tile_.at(tile);
    for (const UnitId id : units) {
        if (intersect(open_.at(id).unit.block, block)) end(id, node, fate);
    }
}

bool UnitLedger::fail(UnitId unit, NodeId node, UnitTrouble::Kind kind, const std::string& message) {
    const auto entry = open_.find(unit);
    if (entry == open_.end() || !entry->second.holders.contains(node)) return false;
    if (!entry->second.is_covered) {
        std::shared_ptr<const UnitTrouble>& trouble = entry->second.trouble;
        UnitTrouble more = trouble ? *trouble : UnitTrouble{};
        more.add(kind, node, message);
        unexplained_.erase(trouble);
        trouble = std::make_shared<const UnitTrouble>(std::move(more));
        if (!trouble->failed_on.empty()) unexplained_.insert(trouble);
    }
    close(entry, node, kind == UnitTrouble::Kind::Failed ? Fate::Refused : Fate::Lost);
    return true;
}

void UnitLedger::node_gone(const Loss& loss) {
    // What was dealt to a node that had ended already never reached it.
    constexpr Duration MinHeld = std::chrono::milliseconds(20);
    std::vector<UnitId> rendered;
    for (const UnitId id : held_by(loss.node)) {  // ids ascend in the order of dealing
        const Duration held = loss.now - open_.at(id).holders.at(loss.node);
        const bool may_be = rendered.size() < loss.rendering && (!loss.has_ended || held >= MinHeld);
        if (may_be) {
            rendered.push_back(id);
        } else {
            end(id, loss.node, Fate::Lost);
        }
    }
    if (loss.rendering > 0) lost_.insert(loss.node);
    const std::optional<UnitId> killer = loss.has_ended ? most_suspect(rendered) : std::nullopt;
    has_losses_ = has_losses_ || !rendered.empty();
    for (const UnitId id : rendered) {
        fail(id, loss.node, id == killer ? UnitTrouble::Kind::Killed : UnitTrouble::Kind::Vanished,
             loss.describe ? loss.describe(open_.at(id).unit) : "");
    }
    by_node_.erase(loss.node);
}

std::size_t UnitLedger::other_losses(const UnitTrouble& trouble) const {
    return static_cast<std::size_t>(std::ranges::count_if(lost_, [&](NodeId node) {
        return !survivors_.contains(node) &&
               std::ranges::find(trouble.lost_with, node) == trouble.lost_with.end();
    }));
}

std::optional<UnitId> UnitLedger::most_suspect(const std::vector<UnitId>& units) const {
    std::optional<UnitId> suspect;
    std::size_t most = 0;
    for (const UnitId id : units) {
        const std::size_t count = lives(open_.at(id).trouble);
        if (count == most) suspect.reset();
        if (count <= most) continue;
        suspect = id;
        most = count;
    }
    return suspect;
}

bool UnitLedger::others_have_doubtful(std::uint32_t tile, NodeId node) const {
    return std::ranges::any_of(open_of_tile_[tile], [&](UnitId id) {
        const Unit& unit = open_.at(id);
        return !unit.is_covered && lives(unit.trouble) > 0 &&
               std::ranges::any_of(unit.holders, [&](const auto& holder) { return holder.first != node; });
    });
}

bool UnitLedger::holds_suspect(NodeId node) const {
    const auto held = by_node_.find(node);
    return held != by_node_.end() && std::ranges::any_of(held->second.units, [&](UnitId unit) {
               return is_suspect(open_.at(unit).trouble);
           });
}

std::vector<Cancellation> UnitLedger::end_all() {
    std::vector<Cancellation> all = holders();
    for (const Cancellation& holder : all) end(holder.unit, holder.node, Fate::Cancelled);
    former_.clear();
    for (auto& units : former_of_tile_) units.clear();
    return all;
}

// ---- failures ----

void UnitLedger::explain(const std::shared_ptr<const UnitTrouble>& trouble, bool nodes_are_to_blame) {
    if (unexplained_.erase(trouble) == 0) return;
    for (const NodeId node : trouble->failed_on)
        explained_.push_back({node, nodes_are_to_blame, trouble->message});
}

void UnitLedger::blame_samples(const std::shared_ptr<const UnitTrouble>& trouble) {
    explain(trouble, false);
    for (const NodeId node : trouble->lost_with) lost_.erase(node);
}

std::uint32_t UnitLedger::unexplained_failures(NodeId node) const {
    return static_cast<std::uint32_t>(std::count_if(
        unexplained_.begin(), unexplained_.end(),
        [&](const std::shared_ptr<const UnitTrouble>& trouble) { return trouble->has_failed_on(node); }));
}

// ---- queries ----

const UnitLedger::Unit* UnitLedger::find(UnitId unit) const {
    const auto entry = open_.find(unit);
    return entry == open_.end() ? nullptr : &entry->second;
}

std::vector<Cancellation> UnitLedger::holders() const {
    std::vector<Cancellation> all;
    for (const auto& [id, unit] : open_) {
        for (const auto& [node, since] : unit.holders) all.push_back({node, id});
    }
    return all;
}

std::vector<UnitId> UnitLedger::held_by(NodeId node) const {
    const auto units = by_node_.find(node);
    if (units == by_node_.end()) return {};
    return {units->second.units.begin(), units->second.units.end()};
}

UnitLedger::Load UnitLedger::load(NodeId node) const {
    const auto held = by_node_.find(node);
    return held == by_node_.end() ? Load{} : Load{held->second.units.size(), held->second.samples};
}

}  // namespace tessera::master
