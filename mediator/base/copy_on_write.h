#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

namespace tessera {

// Copy-on-write: copies share the value until one of them is changed. Never empty. Copies may be read, changed and
// destroyed by different threads, each copy by one thread at a time.
template <class T>
class CopyOnWrite {
  public:
    CopyOnWrite() : node_(new Node) {}
    explicit CopyOnWrite(T value) : node_(new Node{std::move(value)}) {}
    CopyOnWrite(const CopyOnWrite& other) : node_(other.node_) {
        node_->owners.fetch_add(1, std::memory_order_relaxed);
    }
    CopyOnWrite(CopyOnWrite&& other) noexcept : node_(std::exchange(other.node_, nullptr)) {}
    CopyOnWrite& operator=(CopyOnWrite other) noexcept {
        std::swap(node_, other.node_);
        return *this;
    }
    // A moved-from object may only be destroyed or assigned to.
    ~CopyOnWrite() {
        if (node_ && node_->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete node_;
    }

    const T& operator*() const { return node_->value; }
    const T* operator->() const { return &node_->value; }
    T& edit() {
        // Acquires the reads of the last other owner.
        if (node_->owners.load(std::memory_order_acquire) != 1) *this = CopyOnWrite(node_->value);
        return node_->value;
    }

  private:
    struct Node {
        T value{};
        std::atomic<std::uint32_t> owners{1};
    };

    Node* node_;
};

}  // namespace tessera
