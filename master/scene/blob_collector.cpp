#include "master/scene/blob_collector.h"

#include <set>

namespace tessera::master {

void BlobCollector::received(const std::string& user, const scene::BlobRef& blob) {
    if (senders_.try_emplace(blob.hash, Sent{user, blob.byte_size}).second) held_[user] += blob.byte_size;
}

std::uint64_t BlobCollector::held_bytes(const std::string& user) const {
    const auto held = held_.find(user);
    return held == held_.end() ? 0 : held->second;
}

void BlobCollector::forget(const scene::BlobRef& blob) {
    const auto sender = senders_.find(blob.hash);
    if (sender == senders_.end()) return;
    release(sender->second);
    senders_.erase(sender);
}

void BlobCollector::release(const Sent& sent) {
    const auto held = held_.find(sent.user);
    held->second -= sent.bytes;
    if (held->second == 0) held_.erase(held);
}

void BlobCollector::scene_closed() {
    std::erase_if(senders_, [&](const auto& entry) {
        if (blobs_->find(entry.first)) return false;
        release(entry.second);
        return true;
    });
}

void BlobCollector::tick(const SceneAuthority& authority, TimePoint now) {
    std::vector<scene::BlobRef> freed;
    bool is_running = false;
    {
        const std::scoped_lock lock(mutex_);
        freed.swap(freed_);
        is_running = is_running_;
    }
    for (const scene::BlobRef& blob : freed) forget(blob);
    if (interval_ == Duration::zero() || is_running || now - last_ < interval_) return;
    if (authority.transactions() == transactions_ && authority.version() == version_) return;
    last_ = now;
    transactions_ = authority.transactions();
    version_ = authority.version();
    const std::uint64_t mark = blobs_->mark();
    is_running_ = true;  // no task is running that reads it
    if (!thread_) thread_ = std::make_unique<TaskThread>();
    const auto state = std::make_shared<const AuthorityState>(authority.save());
    thread_->post([this, state, mark] { collect(*state, mark); });
}

void BlobCollector::collect(const AuthorityState& state, std::uint64_t mark) {
    std::vector<scene::BlobRef> freed;
    try {
        std::set<Hash256> keep;
        const auto add = [&](const scene::Object* object) {
            if (object == nullptr) return;
            for (const scene::BlobRef& blob : scene::referenced_blobs(*object)) keep.insert(blob.hash);
        };
        for (const auto& [id, object] : state.scene.objects()) add(object.get());
        for (const Transaction& transaction : state.history) {
            for (const auto& [id, change] : transaction.changes.all()) {
                add(change.object.before.get());
                add(change.object.after.get());
            }
        }
        freed = blobs_->erase_unused(keep, mark);
    } catch (const std::bad_alloc&) {
        freed.clear();  // the next time
    }
    const std::scoped_lock lock(mutex_);
    is_running_ = false;
    freed_.insert(freed_.end(), freed.begin(), freed.end());
}

}  // namespace tessera::master
