#include "client/tools/live_target.h"

#include <algorithm>
#include <iostream>
#include <thread>

#include "client/session.h"
#include "client/tools/cluster_options.h"

namespace tessera::tools {

namespace {

// Converts an Error exception to an unexpected value.
template <class Call>
auto guarded(const Call& call) -> Expected<decltype(call())> {
    try {
        if constexpr (std::is_void_v<decltype(call())>) {
            call();
            return {};
        } else {
            return call();
        }
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

std::string joined_problems(const std::vector<std::string>& texts) {
    std::string all;
    for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
    return all;
}

class LiveTarget final : public edit::EditTarget {
  public:
    explicit LiveTarget(const SceneAddress& address)
        : session_(client::connect({address.master, address.keys, address.user}, blobs_, clock_,
                                   session_settings(address.name))) {
        (void)session_->join(
            {.title = address.title,
             .on_place =
                 [](std::uint32_t place) {
                     std::cerr
                         << "tessera edit: the cluster is rendering a batch job: waiting, queue position "
                         << place << "\n";
                 }},
            {});
    }

    const scene::Scene& scene() const override { return session_->scene(); }
    Expected<ObjectId> new_id() override {
        return guarded([&] { return session_->new_id(); });
    }
    void add_blob(scene::BlobPtr blob) override { kept_.push_back(blobs_->insert(std::move(blob))); }
    void refresh() override { session_->refresh(); }

    Expected<edit::SubmitReply> submit(std::vector<scene::Entry> entries, const std::string&) override {
        return guarded([&] {
            const session::EditResult result = session_->submit(std::move(entries));
            if (result.accepted) session_->refresh();
            return edit::SubmitReply{result.accepted, result.transaction, result.problems};
        });
    }
    Expected<std::string> undo(std::optional<std::uint64_t> transaction) override {
        return taken_back(session_->undo(transaction.value_or(scene::UndoLatest)));
    }
    Expected<std::string> redo() override { return taken_back(session_->redo()); }

    Expected<std::vector<edit::HistoryLine>> history(std::uint32_t count) override {
        return guarded([&] {
            std::vector<edit::HistoryLine> lines;
            for (const session::TransactionSummary& entry : session_->history(count)) {
                lines.push_back(
                    {entry.number, entry.name, entry.time, entry.text, entry.undoes, entry.undone_by});
            }
            return lines;
        });
    }
    Expected<std::vector<edit::FieldWriter>> writers(ObjectId object) override {
        return guarded([&] {
            std::vector<edit::FieldWriter> writers;
            for (const session::FieldWriter& writer : session_->writers(object))
                writers.push_back({writer.field, writer.transaction, writer.name});
            return writers;
        });
    }
    Expected<std::vector<edit::Member>> members() override {
        return guarded([&] {
            std::vector<edit::Member> members;
            const session::Members scene_members = session_->members();
            for (const session::Member& member : scene_members.members) {
                edit::Member entry{member.name, member.user, member.text, member.editor, {}};
                for (const session::ObjectLock& lock : scene_members.locks) {
                    if (lock.name == member.name) entry.locked.push_back(lock.object);
                }
                for (const session::ViewEntry& view : scene_members.views) {
                    if (view.owner == member.name)
                        entry.text += (entry.text.empty() ? "view " : "; view ") + view.name;
                }
                members.push_back(std::move(entry));
            }
            return members;
        });
    }
    Expected<void> lock(const std::vector<ObjectId>& objects) override {
        return guarded([&] { session_->lock(objects); });
    }
    Expected<void> unlock(const std::vector<ObjectId>& objects) override {
        return guarded([&] { session_->unlock(objects); });
    }
    Expected<scene::BlobPtr> blob(const scene::BlobRef& reference) override {
        return guarded([&] { return session_->fetch(reference); });
    }
    Expected<void> wait(Duration duration) override {
        std::this_thread::sleep_for(duration);
        return guarded([&] { session_->pump(); });
    }
    Expected<void> close() override {
        return guarded([&] { session_->close_scene(); });
    }

  private:
    Expected<std::string> taken_back(const session::EditResult& result) {
        if (!result.accepted) return failure(ErrorCode::Refused, joined_problems(result.problems));
        return guarded([&] {
            session_->refresh();
            const auto history = session_->history(1);
            std::string text = history.empty() ? "done" : history.front().text;
            for (const std::string& note : result.notes) text += "\n  unchanged: " + note;
            return text;
        });
    }

    SteadyClock clock_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    std::vector<scene::BlobPtr> kept_;  // for entries submitted later
    std::unique_ptr<client::Session> session_;
};

}  // namespace

std::unique_ptr<edit::EditTarget> connect_scene(const SceneAddress& address) {
    return std::make_unique<LiveTarget>(address);
}

}  // namespace tessera::tools
