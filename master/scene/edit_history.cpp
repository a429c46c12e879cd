#include "master/scene/edit_history.h"

#include <algorithm>

namespace tessera::master {

namespace {

template <class Predicate>
std::uint64_t youngest(const std::deque<Transaction>& transactions, const Predicate& is_it) {
    const auto place = std::find_if(transactions.rbegin(), transactions.rend(), is_it);
    return place == transactions.rend() ? 0 : place->number;
}

}  // namespace

Transaction& EditHistory::add(Transaction transaction) {
    transaction.number = ++last_;
    transactions_.push_back(std::move(transaction));
    if (transactions_.size() > Length) transactions_.pop_front();
    return transactions_.back();
}

const Transaction* EditHistory::find(std::uint64_t number) const {
    const auto place =
        std::lower_bound(transactions_.begin(), transactions_.end(), number,
                         [](const Transaction& entry, std::uint64_t n) { return entry.number < n; });
    return place != transactions_.end() && place->number == number ? &*place : nullptr;
}

Transaction* EditHistory::find(std::uint64_t number) {
    return const_cast<Transaction*>(std::as_const(*this).find(number));
}

std::uint64_t EditHistory::latest_to_undo(std::uint64_t editor) const {
    return youngest(transactions_, [&](const Transaction& entry) {
        return entry.editor == editor && entry.nature == Nature::Edit && entry.undone_by == 0;
    });
}

std::uint64_t EditHistory::latest_to_redo(std::uint64_t editor) const {
    return youngest(transactions_, [&](const Transaction& entry) {
        return entry.editor == editor && entry.nature == Nature::Undo && entry.undone_by == 0;
    });
}

void EditHistory::mark_undone(Transaction& target, std::uint64_t by) {
    target.undone_by = by;
    const Transaction* undoer = &target;
    bool in_force = true;
    for (Transaction* next = find(target.undoes); next != nullptr; next = find(next->undoes)) {
        next->undone_by = in_force ? 0 : undoer->number;
        undoer = next;
        in_force = !in_force;
    }
}

const Transaction* EditHistory::remover(ObjectId id) const {
    for (auto entry = transactions_.rbegin(); entry != transactions_.rend(); ++entry) {
        const auto change = entry->changes.all().find(id);
        if (change != entry->changes.all().end() && !change->second.object.after) return &*entry;
    }
    return nullptr;
}

void EditHistory::restore(std::uint64_t last, std::deque<Transaction> transactions) {
    last_ = last;
    transactions_ = std::move(transactions);
}

}  // namespace tessera::master
