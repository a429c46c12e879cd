#pragma once

#include "mediator/base/hash.h"
#include "mediator/base/rect.h"
#include "mediator/frame/sample_block.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/objects.h"
#include "mediator/wire/mapping.h"
#include "proto/common.pb.h"

// Private to wire/*.cpp: how the smallest structures map to their messages.
namespace tessera::wire {

// Steps of motion that are decoded; validation takes far fewer and says so better.
inline constexpr std::size_t MaxSteps = 256;

// Of scenes and of views.
template <>
constexpr scene::Projection last_of() {
    return scene::Projection::Orthographic;
}
template <>
constexpr scene::Aperture last_of() {
    return scene::Aperture::Gaussian;
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Version> s, proto::Version& p) {
    io(s.epoch, p, &proto::Version::epoch, &proto::Version::set_epoch);
    io(s.number, p, &proto::Version::number, &proto::Version::set_number);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Hash128> s, proto::Hash128& p) {
    io(s.high, p, &proto::Hash128::high, &proto::Hash128::set_high);
    io(s.low, p, &proto::Hash128::low, &proto::Hash128::set_low);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<scene::BlobRef> s, proto::BlobRef& p) {
    io(s.byte_size, p, &proto::BlobRef::byte_size, &proto::BlobRef::set_byte_size);
    if (p.byte_size() != 0) io.raw(s.hash.bytes, p.mutable_hash());  // an empty reference has no hash
}

template <class Io>
void map(const Io& io, typename Io::template Ref<Rect> s, proto::Rect& p) {
    io(s.x, p, &proto::Rect::x, &proto::Rect::set_x);
    io(s.y, p, &proto::Rect::y, &proto::Rect::set_y);
    io(s.width, p, &proto::Rect::width, &proto::Rect::set_width);
    io(s.height, p, &proto::Rect::height, &proto::Rect::set_height);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<frame::SampleBlock> s, proto::SampleBlock& p) {
    io(s.first, p, &proto::SampleBlock::first, &proto::SampleBlock::set_first);
    io(s.level, p, &proto::SampleBlock::level, &proto::SampleBlock::set_level);
    if (!s.is_aligned()) malformed("a block of samples is not aligned");
}

}  // namespace tessera::wire
