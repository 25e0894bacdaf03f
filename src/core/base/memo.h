// Results of a function that is asked for the same again and again.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <utility>

namespace lampyris {

// Remembers the results for the first `most` different keys; those of others are computed each time. Thread-safe.
template <typename Key, typename Value>
class Memo {
 public:
    explicit Memo(size_t most) : most_(most) {}

    // The result for the key: of an earlier call, or compute().
    template <typename Compute>
    Value get(const Key& key, const Compute& compute) {
        {
            const std::lock_guard lock(mutex_);
            if (const auto known = values_.find(key); known != values_.end()) return known->second;
        }
        Value value = compute();
        const std::lock_guard lock(mutex_);
        if (values_.size() < most_) values_.emplace(key, value);
        return value;
    }

 private:
    const size_t most_;
    std::mutex mutex_;
    std::map<Key, Value> values_;
};

}  // namespace lampyris
