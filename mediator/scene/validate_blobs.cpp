#include <cmath>

#include "mediator/scene/fields.h"
#include "mediator/scene/validate.h"
#include "mediator/scene/validate_object.h"

namespace tessera::scene {

namespace {

class BlobCheck {
  public:
    BlobCheck(ObjectId id, const Object& object, const BlobStore& blobs)
        : id_(id), object_(object), blobs_(blobs) {}

    // Null, with a problem, if the blob is missing or has another size.
    BlobPtr get(const BlobRef& reference, std::string_view what) {
        if (reference.empty()) return nullptr;
        BlobPtr blob = blobs_.find(reference.hash);
        if (!blob || blob->bytes().size() != reference.byte_size) {
            add("the blob of its " + std::string(what) +
                " is missing, or its size differs from the reference");
            return nullptr;
        }
        return blob;
    }

    void finite(const BlobRef& reference, std::size_t components, std::string_view what) {
        const BlobPtr blob = get(reference, what);
        if (!blob) return;
        const auto values = blob->as<float>();
        std::uint64_t bad = 0, first = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (std::isfinite(values[i])) continue;
            if (bad++ == 0) first = i / components;
        }
        if (bad > 0) {
            add(std::to_string(bad) + " numbers of its " + std::string(what) +
                " are not finite, the first in element " + std::to_string(first) +
                ": fix the file or the exporter");
        }
    }

    void indices(const Geometry& geometry) {
        const BlobPtr blob = get(geometry.indices, "indices");
        if (!blob) return;
        const std::uint64_t vertices = geometry.positions.byte_size / 12;
        const auto values = blob->as<std::uint32_t>();
        std::uint64_t bad = 0, first = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (values[i] < vertices) continue;
            if (bad++ == 0) first = i / 3;
        }
        if (bad > 0) {
            add(std::to_string(bad) + " indices point beyond its " + std::to_string(vertices) +
                " vertices, the first in triangle " + std::to_string(first) +
                ": fix the file or the exporter");
        }
    }

    void texels(const Texture& texture) {
        if (texture.format == TexelFormat::RgbFloat) {
            finite(texture.texels, 3, "texels");
        } else {
            get(texture.texels, "texels");
        }
    }

    void all_finite(const BlobRef& array, std::size_t components, std::string_view what) {
        finite(array, components, what);
    }
    void all_finite(const std::vector<BlobRef>& arrays, std::size_t components, std::string_view what) {
        for (const BlobRef& array : arrays) finite(array, components, what);
    }

    std::vector<Problem> take() { return std::move(problems_); }

  private:
    void add(const std::string& cause) { problems_.push_back({id_, describe(id_, object_) + ": " + cause}); }

    ObjectId id_;
    const Object& object_;
    const BlobStore& blobs_;
    std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> validate_blobs(ObjectId id, const Object& object, const BlobStore& blobs) {
    BlobCheck check(id, object, blobs);
    std::visit(
        [&]<class T>(const T& value) {
            for_each_row<T>([&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
                constexpr auto& row = row_of<T, I>;
                using Row = std::decay_t<decltype(row)>;
                if constexpr (Row::template has<Array>) {
                    if (row.template note<Array>().element == Element::Float32)
                        check.all_finite(row.of(value), row.template note<Array>().components, row.name);
                }
            });
        },
        object);
    if (const auto* geometry = std::get_if<Geometry>(&object)) check.indices(*geometry);
    if (const auto* texture = std::get_if<Texture>(&object)) check.texels(*texture);
    return check.take();
}

}  // namespace tessera::scene
