#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "client/edit/interpreter.h"
#include "client/edit/target.h"
#include "tests/export/rich_scene.h"

namespace tessera::edit {

// A local scene that behaves like one of a master: validates submissions, records transactions and undoes them.
class FakeTarget : public EditTarget {
  public:
    FakeTarget();

    const scene::Scene& scene() const override { return rich_.scene; }
    Expected<ObjectId> new_id() override { return ObjectId{next_id_++}; }
    void add_blob(scene::BlobPtr blob) override { rich_.blobs.insert(std::move(blob)); }
    void refresh() override {}
    Expected<SubmitReply> submit(std::vector<scene::Entry> entries, const std::string& label) override;
    Expected<std::string> undo(std::optional<std::uint64_t> transaction) override;
    Expected<std::string> redo() override;
    Expected<std::vector<HistoryLine>> history(std::uint32_t count) override;
    Expected<std::vector<FieldWriter>> writers(ObjectId object) override;
    Expected<std::vector<Member>> members() override;
    Expected<void> lock(const std::vector<ObjectId>& objects) override;
    Expected<void> unlock(const std::vector<ObjectId>& objects) override;
    Expected<scene::BlobPtr> blob(const scene::BlobRef& reference) override;
    Expected<void> wait(Duration duration) override;
    Expected<void> close() override;

    // Runs the script and returns its output; error() has the error message.
    bool script(std::string_view text);
    bool line(std::string_view text);
    const std::string& printed() const { return printed_; }
    const std::string& error() const { return error_; }
    EditInterpreter& interpreter() { return interpreter_; }

    template <class T>
    const T& named(const std::string& name) const {
        for (const auto& [id, object] : rich_.scene.objects()) {
            const T* found = std::get_if<T>(object.get());
            if (found != nullptr && found->name == name) return *found;
        }
        ADD_FAILURE() << "nothing is named " << name;
        static const T None{};
        return None;
    }
    ObjectId id_of(const std::string& name) const;

    std::vector<std::string> labels;            // of accepted transactions
    std::vector<std::string> calls;             // in order; of edits those that were accepted
    std::size_t refuse_from = ~std::size_t{0};  // this transaction, counted from 0, and later ones
    bool refuse_undo = false;

  private:
    struct Done {
        scene::Scene before;
        std::string label;
    };
    bool take(const Expected<void>& done);

    exporting::RichScene rich_;
    std::uint64_t next_id_ = 70000;
    std::vector<Done> done_;
    std::size_t submits_ = 0;
    std::string printed_, error_;
    EditInterpreter interpreter_;
};

}  // namespace tessera::edit
