#pragma once

#include <deque>
#include <optional>

#include "master/scene/transaction.h"

namespace tessera::master {

// The latest transactions, those that can still be undone. Pure.
class EditHistory {
  public:
    static constexpr std::size_t Length = 256;

    std::uint64_t last() const { return last_; }  // number of the latest ever; 0 = none
    Transaction& add(Transaction transaction);    // assigns the next number; may drop the oldest
    Transaction* find(std::uint64_t number);      // null: unknown or too old
    const Transaction* find(std::uint64_t number) const;

    // This editor's latest transaction in force that is not an undo; its latest undo in force. 0 = none.
    std::uint64_t latest_to_undo(std::uint64_t editor) const;
    std::uint64_t latest_to_redo(std::uint64_t editor) const;
    // `by` undoes `target`, which is no longer in force; what `target` had undone is in force again, and so on.
    void mark_undone(Transaction& target, std::uint64_t by);

    const Transaction* remover(ObjectId id) const;  // the latest that removed the object
    const std::deque<Transaction>& all() const { return transactions_; }  // oldest first
    void clear() { transactions_.clear(); }                               // numbers continue
    void restore(std::uint64_t last, std::deque<Transaction> transactions);

  private:
    std::uint64_t last_ = 0;
    std::deque<Transaction> transactions_;
};

}  // namespace tessera::master
