#include "tests/wire/sample_messages.h"

#include <algorithm>
#include <limits>

#include "mediator/scene/fields.h"

namespace tessera::wire {

scene::ChangeList some_changes() {
    scene::Geometry geometry{.name = "chair \xff", .material = ObjectId{9}};
    geometry.positions = {blake2b({}), 36};
    geometry.indices = {blake2b({}), 12};
    scene::Transform moved;
    moved.matrix[3][1] = -0.0;
    moved.layers = 0x80000001;
    moved.matrix[2][2] = std::numeric_limits<double>::quiet_NaN();
    return {.from = {5, 1},
            .to = {5, 2},
            .entries = {scene::Create{ObjectId{7}, geometry},
                        scene::Update{ObjectId{8},
                                      scene::Fields<scene::Transform>(
                                          {&scene::Transform::matrix, &scene::Transform::layers})
                                          .bits(),
                                      moved},
                        scene::Create{ObjectId{9}, scene::Material{}},
                        scene::Create{ObjectId{10}, scene::Light{}},
                        scene::Create{ObjectId{11}, scene::Texture{.width = 1, .height = 1}},
                        scene::Create{ObjectId{12}, scene::Camera{}},
                        scene::Create{ObjectId{13}, scene::Background{}},
                        scene::Create{ObjectId{14}, scene::Attachment{.key = "k", .value = "v"}},
                        scene::Remove{ObjectId{6}}},
            .state_hash = {1, ~0ull}};
}

view::View some_view() {
    view::View view{.id = ViewId{3},
                    .revision = 9,
                    .seed = 77,
                    .max_bounces = view::UnlimitedBounces,
                    .max_specular_bounces = 7,
                    .clamp_indirect = 2.5f,
                    .sky_cells_from = 16};
    view.camera.left = -0.25;
    view.camera.world_from_camera[3][0] = 1e6;
    view.camera.projection = scene::Projection::Orthographic;
    view.camera.lens_radius = 0.125;
    view.camera.focus_distance = 3.5;
    view.camera.aperture = scene::Aperture::Gaussian;
    view.camera.motion = {glm::dmat4(2.0), glm::dmat4(0.5)};
    view.renderer = view::Renderer::Raster;
    view.path_class = view::PathClass::Caustics;
    view.feature_rule = view::FeatureRule::Connections;
    view.transparent_background = true;
    view.filter = "fdf:radius=4";
    view.layers = 0x80000005;
    view.channels = {frame::Channel::Radiance, frame::Channel::Depth};
    return view;
}

namespace {

const session::NodeSummary node{NodeId{1}, "n", "host", "embree", "embree/avx2", 4711, 3, 4096, 1.5};

std::vector<ControlMessage> peer_messages() {
    const view::WorkUnit unit{UnitId{4}, ViewId{3}, 9, {5, 2}, {32, 64, 32, 32}, {8, 3}};
    return {Hello{.peer = PeerKind::Node,
                  .name = "n",
                  .host = "h",
                  .pid = 5,
                  .channels = {frame::Channel::Albedo},
                  .renderers = {view::Renderer::PathTracing, view::Renderer::Raster},
                  .reproducible = true,
                  .resume_token = 8},
            Welcome{7, 8, 9, std::chrono::seconds(1), 3},
            Refusal{"no"},
            Unknown{},
            Heartbeat{-5, 6, 7, session::NodePhase::Building, 8, {5, 2}, {UnitId{1}, UnitId{2}}, 3, 4},
            Changes{some_changes()},
            ChangesByBlob{{5, 1}, {5, 2}, {blake2b({}), 100}},
            VersionReport{{5, 2}, {1, 2}, 3, 4, 5, 6, 7, 8, 9, 10, 11, {"attachment"}, {"broken"}, -12, 13},
            Resync{{5, 1}, "gap"},
            OpenView{some_view()},
            CloseView{ViewId{3}},
            Work{12, unit},
            CancelUnits{{UnitId{4}}},
            UnitReleased{UnitId{4}, ReleaseReason::Failed, "why"},
            Leave{},
            Goodbye{"bye", {UnitId{4}}},
            Notice{Severity::Error, "text"}};
}

session::ViewSummary some_summary() {
    return {.outcome = session::Outcome::TimeUp,
            .seconds_render = 0.25,
            .nodes = {node},
            .picture = {.encoding = session::PictureEncoding::Planes,
                        .width = 3,
                        .height = 2,
                        .components = 4,
                        .byte_size = 96,
                        .filter = "gauss:sigma=3",
                        .passes = {{"gauss", 0.5, 40.0}},
                        .notes = {"upsampled"}},
            .min_samples = 3,
            .max_samples = 9};
}

session::ClusterStatus some_status() {
    return {.software = "s",
            .nodes = {{.summary = node,
                       .phase = session::NodePhase::Leaving,
                       .stuck = true,
                       .clock_offset_seconds = -0.5,
                       .clock_bound_seconds = 0.25,
                       .film_bytes = 5,
                       .faults = 2,
                       .last_fault = "it failed"}},
            .scene = {.title = "room",
                      .exclusive = true,
                      .members = 2,
                      .edits = 7,
                      .stages = {{"first picture", 9, 0.02, 0.05}}}};
}

std::vector<ControlMessage> scene_messages() {
    return {SubmitEdit{{SessionId{2}, 3, {5, 1}, some_changes().entries, 4, -5, 6}},
            SubmitEditByBlob{SessionId{2}, 3, {5, 1}, {blake2b({}), 5}},
            EditReply{3, {true, {5, 2}, {"p"}, 7, {"n"}}},
            StatusRequest{},
            StatusReply{some_status()},
            SceneRefused{{5, 1}, "too large"},
            JoinScene{"room", "ann", 0xfedcba9876543210, true, true},
            SceneJoined{{5, 1}, 65536, 100, 3, "room", "ann (2)", 2},
            RequestDone{1, true, "why", true},
            CloseScene{2},
            ReadScene{3, {5, 1}},
            SceneContent{4, some_changes(), {blake2b({}), 5}},
            LockObjects{5, {ObjectId{7}}, true},
            SetPresence{"looks", {ObjectId{7}}, std::chrono::seconds(5)},
            ReadMembers{6},
            Members{6,
                    {"room",
                     {{SessionId{1}, "ann", "editor", "looks", {ObjectId{7}}, true, -0.5, 0.25}},
                     {{ObjectId{7}, "ann"}},
                     {{"main", "ann", 64, 32, 5, 9, 2}}}},
            ReadHistory{7, 20},
            History{7, {{3, "ann", "editor", -4, 5, "set", 2, 6}}},
            ReadWriters{8, ObjectId{7}},
            Writers{8, {{2, 3, "ann", "editor", 4}}}};
}

std::vector<ControlMessage> view_and_display_messages() {
    const session::ViewRequest wanted{.name = "main",
                                      .view = some_view(),
                                      .stop = {.spp = 5,
                                               .time_limit = std::chrono::seconds(2),
                                               .budget = std::chrono::milliseconds(800),
                                               .adapts_size = true,
                                               .uniform = true},
                                      .policy = session::Policy::Cooperative,
                                      .tile = 64,
                                      .min_nodes = 2,
                                      .frames = session::Frames::Last,
                                      .picture = session::PictureEncoding::Png,
                                      .detached = true};
    return {FrameTaken{1, 12},
            Pick{10, 1, 3, 4},
            Picked{10, {{5, 1}, true, ObjectId{7}, {1, 2, 3}, {0, 1, 0}, 4.5}, "none"},
            ReadTrace{11, 10},
            Trace{11, {{3, "ann", 40, 1, 2, 3, 4, {{"node-1", 5, 6, 7}}, 8, {5, 2}}}},
            OpenDisplay{12, {blake2b({}), 100}},
            CloseDisplay{13},
            AdjustDisplay{14, {0.06, 2.0, -1.0, true, 3}},
            MoveHead{{{0.1, 1.7, 0.0}, {1.0, 0.0, 0.0, 0.0}}},
            JoinOutput{15, "left"},
            OutputOpened{15, {{blake2b({}), 100}, 3, true}},
            OutputReady{9},
            PresentFrame{{9, {5, 3}, 1000, 10}},
            RequestView{9, 1, wanted, true, EarlierFilm{{blake2b({}), 100}, {3, 4}, 2, "embree-4"}},
            EndView{1, true},
            ViewProgress{1, {session::Phase::Delivering, 1, 2, 3, 4, std::chrono::milliseconds(5)}},
            ViewDone{1, 7, some_summary()},
            SetViewFilter{16, "main", "fdf:radius=3"},
            ReadJobs{17},
            Jobs{17,
                 {{.job = {"ann", "night"},
                   .scene = "room",
                   .has_ended = true,
                   .progress = {.samples = 5},
                   .summary = some_summary(),
                   .ended_at = -6}}},
            FetchJob{18, 2, {"ann", "night"}},
            CancelJob{19, {"", "night"}},
            FilmTaken{1 << 20},
            ManageNode{20, "render-7", ManageNode::Order::Drain}};
}

}  // namespace

std::vector<ControlMessage> control_messages() {
    std::vector<ControlMessage> all = peer_messages();
    for (const auto& more : {scene_messages(), view_and_display_messages()})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

std::vector<BulkMessage> bulk_messages() {
    frame::FilmTile film({0, 32, 3, 2}, {4, 2}, {frame::Channel::Radiance, frame::Channel::ObjectIndex});
    std::fill(film.counts.begin(), film.counts.end(), 4u);
    frame::FilmTile uneven = film;
    uneven.counts[2] = 3;
    uneven.nonfinite_samples = 1;
    return {BulkHello{5},
            BlobRequest{blake2b({}), 7},
            BlobChunk{blake2b({}), 100, 10, std::vector<std::byte>(50)},
            BlobAbsent{blake2b({})},
            FilmPart{UnitId{1}, ViewId{2}, 3, {4, 5}, 2, 6, 7, film},
            FilmPart{UnitId{1}, ViewId{2}, 3, {4, 5}, 0, 6, 7, uneven},
            FrameTile{1, 2, 3, uneven},
            FilmBlock{1, 2, 3, 1, false, uneven},
            FilmBlock{1, 2, 3, 0, true, frame::FilmTile({0, 32, 3, 2}, {4, 2}, {frame::Channel::Alpha})},
            PictureChunk{1, 100, 10, std::vector<std::byte>(50)},
            OutputPicture{.frame = 7,
                          .eye = view::Eye::Right,
                          .eyes = 2,
                          .version = {5, 3},
                          .width = 8,
                          .height = 4,
                          .encoding = session::PictureEncoding::Half,
                          .samples = 2,
                          .total = 192,
                          .offset = 10,
                          .data = std::vector<std::byte>(50)},
            FrameHeader{.view = 1,
                        .frame = 2,
                        .version = {5, 3},
                        .revision = 4,
                        .scale = 8,
                        .width = 160,
                        .height = 90,
                        .components = 3,
                        .encoding = session::PictureEncoding::Jpeg,
                        .picture_bytes = 1000,
                        .film_window = {0, 0, 160, 90},
                        .film_tiles = 4,
                        .min_samples = 1,
                        .max_samples = 2,
                        .spp = 64,
                        .complete = true,
                        .film_hash = blake2b({}),
                        .mean_samples = 1.5,
                        .noise = 0.25}};
}

}  // namespace tessera::wire
