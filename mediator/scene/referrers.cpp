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
    if (kind == ObjectKind::Root) return Fields<Root>(Root::Field::Children).bits();
    if (kind == ObjectKind::Transform) return Fields<Transform>(Transform::Field::Children).bits();
    return 0;
}

std::vector<Reference> references(const Object& object) {
    constexpr std::uint32_t Children = bit(ObjectKind::Transform) | bit(ObjectKind::Geometry) |
                                       bit(ObjectKind::Light) | bit(ObjectKind::Camera) |
                                       bit(ObjectKind::Attachment);
    std::vector<Reference> found;
    const auto add = [&](ObjectId id, std::uint32_t kinds, const char* role) {
        if (id) found.push_back({id, kinds, role});
    };
    for (const ObjectId child : children(object)) found.push_back({child, Children, "child"});
    if (const auto* root = std::get_if<Root>(&object)) {
        add(root->background, bit(ObjectKind::Background), "background");
    } else if (const auto* geometry = std::get_if<Geometry>(&object)) {
        add(geometry->material, bit(ObjectKind::Material) | bit(ObjectKind::SurfaceShader), "material");
        add(geometry->medium, bit(ObjectKind::Medium), "medium");
    } else if (const auto* background = std::get_if<Background>(&object)) {
        add(background->environment, bit(ObjectKind::Texture), "environment");
    }
    std::visit(
        [&]<class T>(const T& value) {
            for_each_field<T>([&](unsigned field, auto member) {
                if constexpr (std::is_same_v<std::decay_t<decltype(value.*member)>, TextureSlot>) {
                    add((value.*member).texture, bit(ObjectKind::Texture),
                        field_name(kind(object), field).data());
                }
            });
        },
        object);
    return found;
}

FieldMask reference_fields(ObjectKind kind) {
    FieldMask mask = 0;
    const auto add = [&]<class T>(const T& value) {
        for_each_field<T>([&](unsigned field, auto member) {
            using V = std::decay_t<decltype(value.*member)>;
            if constexpr (std::is_same_v<V, ObjectId> || std::is_same_v<V, std::vector<ObjectId>> ||
                          std::is_same_v<V, TextureSlot>) {
                mask |= field_bit(field);
            }
        });
    };
    const auto look = [&]<std::size_t... I>(std::index_sequence<I...>) {
        ((static_cast<std::size_t>(kind) == I ? add(std::variant_alternative_t<I, Object>()) : void()), ...);
    };
    look(std::make_index_sequence<std::variant_size_v<Object>>{});
    return mask;
}

ReferenceChange reference_change(const Object* before, const Object* after) {
    std::vector<Reference> old = before ? references(*before) : std::vector<Reference>();
    std::vector<Reference> now = after ? references(*after) : std::vector<Reference>();
    // Mostly one child comes or goes in a long list: what is the same at both ends needs no sorting.
    const std::size_t shorter = std::min(old.size(), now.size());
    std::size_t head = 0, tail = 0;
    while (head < shorter && same(old[head], now[head])) ++head;
    while (tail < shorter - head && same(old[old.size() - 1 - tail], now[now.size() - 1 - tail])) ++tail;
    const auto middle = [&](std::vector<Reference>& list) {
        std::vector<Reference> part(list.begin() + static_cast<std::ptrdiff_t>(head),
                                    list.end() - static_cast<std::ptrdiff_t>(tail));
        std::sort(part.begin(), part.end(), before_in_order);
        return part;
    };
    const std::vector<Reference> from = middle(old), to = middle(now);
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
        const auto place = counts_.find({reference.id, id});
        if (place != counts_.end() && --place->second == 0) counts_.erase(place);
    }
    for (const Reference& reference : change.added) ++counts_[{reference.id, id}];
}

std::vector<ObjectId> ReferrerIndex::referrers(ObjectId target) const {
    std::vector<ObjectId> found;
    for (auto place = counts_.lower_bound({target, ObjectId{}});
         place != counts_.end() && place->first.first == target; ++place) {
        found.push_back(place->first.second);
    }
    return found;
}

}  // namespace tessera::scene
