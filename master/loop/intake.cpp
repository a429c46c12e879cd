#include "master/loop/intake.h"

#include <algorithm>

namespace tessera::master {

bool Intake::put(net::Message& message) {
    Key& key = keys_[message.user];
    if (key.messages.size() >= MaxMessages || key.bytes + message.bytes.size() > MaxBytes) return false;
    // Time that a key did not use is not saved up.
    if (key.messages.empty()) key.used = std::max(key.used, served_);
    key.bytes += message.bytes.size();
    key.messages.push_back(std::move(message));
    ++waiting_;
    return true;
}

net::Message Intake::take() {
    auto next = keys_.end();
    for (auto entry = keys_.begin(); entry != keys_.end(); ++entry) {
        const bool is_first = next == keys_.end() || entry->second.used < next->second.used;
        if (!entry->second.messages.empty() && is_first) next = entry;
    }
    Key& key = next->second;
    net::Message message = std::move(key.messages.front());
    key.messages.pop_front();
    key.bytes -= message.bytes.size();
    served_ = std::max(served_, key.used);
    --waiting_;
    return message;
}

void Intake::used(const std::string& user, Duration spent) {
    if (const auto key = keys_.find(user); key != keys_.end()) key->second.used += spent;
    constexpr std::size_t MaxKeys = 4096;
    if (keys_.size() > MaxKeys)
        std::erase_if(keys_, [](const auto& entry) { return entry.second.messages.empty(); });
}

}  // namespace tessera::master
