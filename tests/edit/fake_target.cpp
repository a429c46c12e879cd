#include "tests/edit/fake_target.h"

#include "mediator/scene/validate.h"

namespace tessera::edit {

FakeTarget::FakeTarget() : interpreter_(*this, [this](std::string_view text) { printed_ += text; }) {
    exporting::make_rich(rich_);
}

Expected<SubmitReply> FakeTarget::submit(std::vector<scene::Entry> entries, const std::string& label) {
    if (submits_++ >= refuse_from) return SubmitReply{false, 0, {"another client holds it"}};
    const scene::Scene before = rich_.scene;
    if (const auto applied = rich_.scene.apply_entries(entries); !applied) {
        return SubmitReply{false, 0, {applied.error().what()}};
    }
    const auto problems = scene::validate(rich_.scene);
    EXPECT_TRUE(problems.empty()) << problems.front().message;
    done_.push_back({before, label});
    labels.push_back(label);
    calls.push_back("submit " + std::to_string(done_.size()));
    return SubmitReply{true, done_.size(), {}};
}

Expected<std::string> FakeTarget::undo(std::optional<std::uint64_t> transaction) {
    if (refuse_undo) return failure(ErrorCode::Refused, "it is too old");
    const std::uint64_t number = transaction.value_or(done_.size());
    calls.push_back("undo " + std::to_string(number));
    if (number == 0 || number > done_.size())
        return failure(ErrorCode::NotFound, "there is no such transaction");
    rich_.scene = done_[number - 1].before;
    return done_[number - 1].label;
}

Expected<std::string> FakeTarget::redo() {
    calls.push_back("redo");
    return std::string("it");
}

Expected<std::vector<HistoryLine>> FakeTarget::history(std::uint32_t count) {
    std::vector<HistoryLine> lines;
    for (std::size_t i = done_.size(); i-- > 0 && lines.size() < count;) {
        lines.push_back({i + 1, "anna", 1'700'000'000'000'000'000, done_[i].label, 0, 0});
    }
    return lines;
}

Expected<std::vector<FieldWriter>> FakeTarget::writers(ObjectId object) {
    calls.push_back("writers " + std::to_string(object.value));
    if (rich_.scene.find(object) == nullptr) return failure(ErrorCode::NotFound, "there is no such object");
    return std::vector<FieldWriter>{{1, 7, "anna"}};
}

Expected<std::vector<Member>> FakeTarget::members() {
    return std::vector<Member>{{"anna", "editor", "paints", true, {id_of("left")}},
                               {"wall", "", "", false, {}}};
}

Expected<void> FakeTarget::lock(const std::vector<ObjectId>& objects) {
    for (const ObjectId id : objects) calls.push_back("lock " + std::to_string(id.value));
    return {};
}

Expected<void> FakeTarget::unlock(const std::vector<ObjectId>& objects) {
    for (const ObjectId id : objects) calls.push_back("unlock " + std::to_string(id.value));
    return {};
}

Expected<scene::BlobPtr> FakeTarget::blob(const scene::BlobRef& reference) {
    if (scene::BlobPtr found = rich_.blobs.find(reference.hash)) return found;
    return failure(ErrorCode::NotFound, "the blob is not here");
}

Expected<void> FakeTarget::wait(Duration duration) {
    calls.push_back("wait " + std::to_string(duration.count()));
    return {};
}

Expected<void> FakeTarget::close() {
    calls.push_back("close");
    return {};
}

bool FakeTarget::take(const Expected<void>& done) {
    error_ = done ? "" : done.error().what();
    return done.has_value();
}

bool FakeTarget::script(std::string_view text) {
    printed_.clear();
    return take(interpreter_.run_script("test.txt", text));
}

bool FakeTarget::line(std::string_view text) {
    printed_.clear();
    return take(interpreter_.run_line(text));
}

ObjectId FakeTarget::id_of(const std::string& name) const {
    for (const auto& [id, object] : rich_.scene.objects()) {
        if (scene::name(*object) == name) return id;
    }
    ADD_FAILURE() << "nothing is named " << name;
    return {};
}

}  // namespace tessera::edit
