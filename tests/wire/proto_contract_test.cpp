// The descriptions of structures say what the files of proto/ say, field by field, and the codec's bytes are those of
// libprotobuf. So neither can change without the other.
#include "tests/wire/proto_contract.h"

#include "mediator/view/work_unit.h"
#include "mediator/wire/entry_codec.h"
#include "proto/scene.pb.h"
#include "proto/work.pb.h"

namespace tessera::wire::test {
namespace {

TEST(ProtoContract, SmallStructures) {
    expect_contract<Version, proto::Version>();
    expect_contract<Hash128, proto::Hash128>();
    expect_contract<Rect, proto::Rect>();
    expect_contract<frame::SampleBlock, proto::SampleBlock>();
    expect_contract<scene::BlobRef, proto::BlobRef>();
    expect_contract<view::WorkUnit, proto::WorkUnit>();
}

TEST(ProtoContract, SceneObjects) {
    expect_contract<scene::Object, proto::Object>();
}

}  // namespace
}  // namespace tessera::wire::test
