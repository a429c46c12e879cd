#include "tests/bench/live/live_bench.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "client/import/import.h"
#include "mediator/scene/fields.h"
#include "mediator/view/placed_cameras.h"
#include "tests/bench/live/live_cluster.h"

namespace tessera::tools::bench {

namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t View = 1;

double since(TimePoint start, const Clock& clock) {
    return seconds(clock.now() - start);
}

// The cluster, its scene, and a watching client.
class LiveBench {
  public:
    LiveBench(const LiveOptions& options, const std::function<void(const std::string&)>& report,
              std::stop_token stop)
        : options_(options), report_(report), stop_(stop), cluster_(options.nodes, options.backend) {}

    LiveResults run() {
        report_("importing the scene");
        watcher_ = cluster_.join("watcher", blobs_, clock_);
        load();
        open_view();
        wait_for_frame(true);
        measure_sequential_edits();
        drag();
        measure_flood();
        const session::ClusterStatus status = cluster_.status(clock_);
        for (const session::StageTimes& stage : status.scene.stages) {
            if (stage.name != "cancel to stopped") continue;
            results_.cancel_p50 = stage.p50_seconds;
            results_.cancel_p99 = stage.p99_seconds;
            results_.cancellations = stage.count;
        }
        results_.versions = status.scene.versions;
        if (status.scene.edits > 0)
            results_.bytes_per_edit = double(status.scene.edit_bytes) / double(status.scene.edits);
        if (status.scene.versions > 0)
            results_.bytes_per_version = double(status.scene.change_bytes) / double(status.scene.versions);
        return std::move(results_);
    }

  private:
    void load() {
        const ObjectId first = watcher_->new_id();
        auto imported = import::import_scene(options_.scene, {.first_id = first});
        if (!imported) throw imported.error();
        for (const scene::BlobPtr& blob : imported->blobs) blobs_->insert(blob);
        auto entries = import::entries(*imported, import::RootEntry::Update);
        for (const scene::Create& create : imported->objects) {
            if (std::holds_alternative<scene::Material>(create.object)) materials_.push_back(create.id);
            while (watcher_->new_id() < create.id) {
            }
        }
        if (materials_.empty())
            throw Error(ErrorCode::InvalidInput, "the scene has no materials to edit: choose another one");
        const auto result = watcher_->submit(std::move(entries));
        if (!result.accepted) throw Error(ErrorCode::Refused, result.problems.front());
        watcher_->refresh();
    }

    void open_view() {
        const auto camera = view::choose_camera(watcher_->scene(), "");
        if (!camera) throw camera.error();
        request_.stop.spp = 1u << 20;
        request_.view.width = options_.width;
        request_.view.height = options_.height;
        request_.view.window = {0, 0, std::int32_t(options_.width), std::int32_t(options_.height)};
        request_.view.camera = view::pose(*camera, options_.width, options_.height);
        request_.view.channels = {frame::Channel::Radiance};
        watcher_->request_view(View, request_);
    }

    void wait_for_frame(bool full) {
        const TimePoint deadline = clock_.now() + 60s;
        while (const auto frame = watcher_->next_frame(deadline, stop_)) {
            if (!full || frame->scale == 1) return;
        }
        throw Error(ErrorCode::Unavailable, "no picture was received: see the logs of the nodes");
    }

    static std::vector<scene::Entry> paint(ObjectId material, double phase) {
        scene::Material wanted;
        const auto wave = [&](double shift) { return float(0.5 + 0.4 * std::sin(phase + shift)); };
        wanted.base_color = {wave(0.0), wave(2.1), wave(4.2), 1.0f};
        return {scene::Update{material, scene::Fields<scene::Material>(&scene::Material::base_color).bits(),
                              wanted}};
    }

    // Waits between edits, so that they arrive during every kind of pass.
    void wait_between_edits(std::uint64_t i) {
        const TimePoint until = clock_.now() + 60ms + 7ms * static_cast<int>(i * 37 % 60);
        while (watcher_->next_frame(until, stop_)) {
        }
    }

    void measure_sequential_edits() {
        for (std::uint64_t i = 0; i < options_.edits && !stop_.stop_requested(); ++i) {
            report_("edit " + std::to_string(i + 1) + " of " + std::to_string(options_.edits));
            wait_between_edits(i);
            const TimePoint start = clock_.now();
            const auto result = watcher_->submit(paint(materials_[i % materials_.size()], 0.7 * double(i)));
            results_.edit_to_answer.seconds.push_back(since(start, clock_));
            if (!result.accepted) throw Error(ErrorCode::Refused, result.problems.front());
            while (const auto frame = watcher_->next_frame(start + 30s, stop_)) {
                if (frame->version.number < result.version.number) continue;
                results_.edit_to_picture.seconds.push_back(since(start, clock_));
                break;
            }
        }
    }

    void drag() {
        std::uint64_t seen = 0;
        const glm::dvec4 position = request_.view.camera.world_from_camera[3];
        for (std::uint64_t i = 0; i < options_.edits && !stop_.stop_requested(); ++i) {
            report_("camera " + std::to_string(i + 1) + " of " + std::to_string(options_.edits));
            wait_between_edits(i);
            while (const auto frame = watcher_->next_frame(clock_.now(), stop_)) seen = frame->revision;
            const TimePoint start = clock_.now();
            request_.view.camera.world_from_camera[3] =
                position + 0.01 * std::sin(double(i)) * request_.view.camera.world_from_camera[0];
            watcher_->set_camera(View, request_.view.camera);
            while (const auto frame = watcher_->next_frame(start + 30s, stop_)) {
                if (frame->revision <= seen) continue;
                seen = frame->revision;
                results_.camera_to_picture.seconds.push_back(since(start, clock_));
                break;
            }
        }
    }

    // The time at which the first edit of each version was answered.
    struct AnswerTimes {
        std::mutex mutex;  // protects since
        std::map<std::uint64_t, TimePoint> since;
    };

    void submit_edits(std::uint32_t editor, AnswerTimes& answer_times, std::stop_token stop) {
        const auto session =
            cluster_.join("editor " + std::to_string(editor), std::make_shared<scene::BlobStore>(), clock_);
        const auto take = [&] {
            const std::vector<session::EditResult> answers = session->take_results();
            const std::scoped_lock lock(answer_times.mutex);
            for (const session::EditResult& result : answers) {
                flood_accepted_ += result.accepted ? 1 : 0;
                answer_times.since.try_emplace(result.version.number, clock_.now());
            }
        };
        const double interval = options_.editors / double(options_.rate);
        const TimePoint start = clock_.now();
        std::uint64_t sent = 0;
        while (!stop.stop_requested()) {
            const auto due = static_cast<std::uint64_t>(since(start, clock_) / interval);
            for (; sent < due; ++sent) {
                session->submit_ahead(
                    paint(materials_[(editor + sent) % materials_.size()], 0.01 * double(sent)));
            }
            take();
            std::this_thread::sleep_for(std::chrono::duration<double>(interval));
        }
        session->settle();
        take();
        flood_edits_ += sent;
    }

    void measure_flood() {
        AnswerTimes answer_times;
        const TimePoint start = clock_.now();
        {
            std::vector<std::jthread> editors;
            for (std::uint32_t editor = 0; editor < options_.editors; ++editor) {
                editors.emplace_back([this, editor, &answer_times](std::stop_token stop) {
                    try {
                        submit_edits(editor, answer_times, stop);
                    } catch (const Error& error) {
                        report_(error.what());
                    }
                });
            }
            bool early = false;
            const TimePoint end = start + std::chrono::duration_cast<Duration>(
                                              std::chrono::duration<double>(options_.flood_seconds));
            while (clock_.now() < end && !stop_.stop_requested()) {
                if (!early && since(start, clock_) > std::min(10.0, 0.3 * options_.flood_seconds)) {
                    early = true;
                    results_.memory_early = cluster_.master_memory();
                }
                const auto frame = watcher_->next_frame(std::min(end, clock_.now() + 100ms), stop_);
                if (!frame) continue;
                ++results_.flood_pictures;
                if (results_.flood_pictures % 10 == 0)
                    report_(std::to_string(results_.flood_pictures) + " pictures, " +
                            std::to_string(int(since(start, clock_))) + " s of edits");
                const TimePoint now = clock_.now();
                const std::scoped_lock lock(answer_times.mutex);
                const auto newer = answer_times.since.upper_bound(frame->version.number);
                TimePoint first = now;
                for (auto entry = newer; entry != answer_times.since.end(); ++entry)
                    first = std::min(first, entry->second);
                results_.picture_age.seconds.push_back(seconds(now - first));
                answer_times.since.erase(answer_times.since.begin(),
                                         answer_times.since.lower_bound(frame->version.number));
            }
            results_.flood_seconds = since(start, clock_);
        }
        results_.memory_late = cluster_.master_memory();
        results_.flood_edits = flood_edits_;
        results_.flood_accepted = flood_accepted_;
        compare_replicas();
    }

    // Nodes check the hash of every version, and request the whole scene when it differs.
    void compare_replicas() {
        watcher_->refresh();
        const auto late = cluster_.join("late", std::make_shared<scene::BlobStore>(), clock_);
        const auto all_up_to_date = [&](const session::ClusterStatus& status) {
            return std::all_of(status.nodes.begin(), status.nodes.end(),
                               [&](const auto& node) { return node.version == status.version; });
        };
        session::ClusterStatus status = cluster_.status(clock_);
        const TimePoint deadline = clock_.now() + 10s;
        while (!all_up_to_date(status) && clock_.now() < deadline) status = cluster_.status(clock_);
        results_.replicas_agree = all_up_to_date(status) && status.resyncs == 0 &&
                                  status.version == watcher_->scene().version() &&
                                  late->scene().state_hash() == watcher_->scene().state_hash();
    }

    LiveOptions options_;
    std::function<void(const std::string&)> report_;
    std::stop_token stop_;
    SteadyClock clock_;
    LiveCluster cluster_;
    std::unique_ptr<client::Session> watcher_;
    session::ViewRequest request_;
    std::vector<ObjectId> materials_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    std::atomic<std::uint64_t> flood_edits_ = 0, flood_accepted_ = 0;
    LiveResults results_;
};

}  // namespace

double Times::percentile(double part) const {
    if (seconds.empty()) return 0.0;
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(part * double(sorted.size() - 1) + 0.5)];
}

LiveResults run_live(const LiveOptions& options, const std::function<void(const std::string&)>& report,
                     std::stop_token stop) {
    return LiveBench(options, report, stop).run();
}

}  // namespace tessera::tools::bench
