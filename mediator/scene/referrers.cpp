#include "mediator/scene/referrers.h"

#include <algorithm>
#include <tuple>

#include "mediator/scene/fields.h"

namespace tessera::scene {

namespace {

bool same(const Reference& a, const Reference& b) {
    return a.id == b.id && a.kinds == b.kinds;
}

bool before_in_order(const Reference& a, const Reference& b) {
    return std::tie(a.id, a.kinds) < std::tie(b.id, b.kinds);
}

}  // namespace

const std::vector<ObjectId>& children(const Object& object) {
    static const std::vector<ObjectId> None;
    if (const auto* transform = std::get_if<Transform>(&object)) return transform->children;
    if (const auto* root = std::get_if<Root>(&object)) return root->children;
    return None;
}

FieldMask children_field(ObjectKind kind) {
    if (kind == ObjectKind::Root) return Fields<Root>(&Root::children).bits();
    if (kind == ObjectKind::Transform) return Fields<Transform>(&Transform::children).bits();
    return 0;
}

std::vector<Reference> references(const Object& object) {
    std::vector<Reference> found;
    const auto collect = [&](const auto& row, const auto& value) {
        using Row = std::decay_t<decltype(row)>;
        using V = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<V, TextureSlot>) {
            if (value.texture) found.push_back({value.texture, bit(ObjectKind::Texture), row.name});
        } else if constexpr (std::is_same_v<V, ObjectId>) {
            static_assert(Row::template has<Refers>, "a reference needs a Refers note");
            if (value) found.push_back({value, row.template note<Refers>().kinds, row.name});
        } else if constexpr (std::is_same_v<V, std::vector<ObjectId>>) {
            for (const ObjectId id : value)
                found.push_back({id, row.template note<Refers>().kinds, row.name});
        }
    };
    std::visit(
        [&]<class T>(const T& value) {
            for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
                collect(row_of<T, I>, row_of<T, I>.of(value));
            });
        },
        object);
    return found;
}

FieldMask reference_fields(ObjectKind kind) {
    FieldMask mask = 0;
    with_kind(kind, [&]<class T>() {
        for_each_field<T>([&](unsigned index, auto member) {
            using V = std::decay_t<decltype(std::declval<T>().*member)>;
            if constexpr (std::is_same_v<V, ObjectId> || std::is_same_v<V, std::vector<ObjectId>> ||
                          std::is_same_v<V, TextureSlot>) {
                mask |= field_bit(index);
            }
        });
    });
    return mask;
}

ReferenceChange reference_change(const Object* before, const Object* after) {
    std::vector<Reference> old = before ? references(*before) : std::vector<Reference>();
    std::vector<Reference> now = after ? references(*after) : std::vector<Reference>();
    // Usually one child is added to or removed from a long list: only the part that differs is sorted.
    const std::size_t shorter = std::min(old.size(), now.size());
    std::size_t head = 0, tail = 0;
    while (head < shorter && same(old[head], now[head])) ++head;
    while (tail < shorter - head && same(old[old.size() - 1 - tail], now[now.size() - 1 - tail])) ++tail;
    const auto differing_part = [&](std::vector<Reference>& list) {
        std::vector<Reference> part(list.begin() + static_cast<std::ptrdiff_t>(head),
                                    list.end() - static_cast<std::ptrdiff_t>(tail));
        std::sort(part.begin(), part.end(), before_in_order);
        return part;
    };
    const std::vector<Reference> from = differing_part(old), to = differing_part(now);
    ReferenceChange change;
    std::set_difference(to.begin(), to.end(), from.begin(), from.end(), std::back_inserter(change.added),
                        before_in_order);
    std::set_difference(from.begin(), from.end(), to.begin(), to.end(), std::back_inserter(change.removed),
                        before_in_order);
    return change;
}

void ReferrerIndex::replace(ObjectId id, const Object* before, const Object* after) {
    const ReferenceChange change = reference_change(before, after);
    for (const Reference& reference : change.removed) {
        const auto it = counts_.find({reference.id, id});
        if (it != counts_.end() && --it->second == 0) counts_.erase(it);
    }
    for (const Reference& reference : change.added) ++counts_[{reference.id, id}];
}

std::vector<ObjectId> ReferrerIndex::referrers(ObjectId target) const {
    std::vector<ObjectId> found;
    for (auto it = counts_.lower_bound({target, ObjectId{}});
         it != counts_.end() && it->first.first == target; ++it) {
        found.push_back(it->first.second);
    }
    return found;
}

}  // namespace tessera::scene
