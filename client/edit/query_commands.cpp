#include <algorithm>
#include <set>

#include "client/edit/command_functions.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "mediator/scene/fields.h"

namespace tessera::edit {
namespace {

using scene::ObjectKind;

// Sorted by kind, then name.
void print_names(DryRun& dry_run, std::string_view kind_pattern, std::string_view name_pattern) {
    const scene::Scene& scene = dry_run.scene();
    std::string text;
    for (const scene::KindRow& row : scene::Kinds) {
        if (!matches(kind_pattern, row.plural)) continue;
        for (const auto& [name, ids] : dry_run.path_index().names(row.kind)) {
            if (!matches(name_pattern, name)) continue;
            for (const ObjectId id : ids) text += dry_run.path_index().path(scene, id) + "\n";
        }
    }
    dry_run.print(text.empty() ? "no matches\n" : text);
}

// Depth first with an explicit stack, since graphs may be deep. Repeated instances are not expanded again.
class Tree {
  public:
    explicit Tree(const DryRun& dry_run) : dry_run_(dry_run), scene_(dry_run.scene()) {}

    std::string text(ObjectId top) {
        stack_.push_back({top, 0});
        while (!stack_.empty()) {
            const Place place = stack_.back();
            stack_.pop_back();
            visit(place);
        }
        return std::move(text_);
    }

  private:
    struct Place {
        ObjectId id;
        std::size_t depth;
    };
    void visit(const Place& place) {
        text_ += std::string(2 * place.depth, ' ') + dry_run_.path(place.id);
        const auto* transform = scene_.find_as<scene::Transform>(place.id);
        const auto* root = scene_.find_as<scene::Root>(place.id);
        const bool has_children =
            (transform && !transform->children.empty()) || (root && !root->children.empty());
        if (!has_children || !seen_.insert(place.id).second) {
            text_ += has_children ? "  (as above)\n" : "\n";
            return;
        }
        text_ += "\n";
        const auto& children = transform ? transform->children : root->children;
        for (auto child = children.rbegin(); child != children.rend(); ++child)
            stack_.push_back({*child, place.depth + 1});
    }

    const DryRun& dry_run_;
    const scene::Scene& scene_;
    std::vector<Place> stack_;
    std::set<ObjectId> seen_;
    std::string text_;
};

struct ShownField {
    std::string text;
    bool is_committed = true;
};

std::string shown(const std::string& title, const std::vector<ShownField>& fields,
                  const std::vector<FieldWriter>& writers) {
    std::string text = title + "\n";
    for (unsigned i = 0; i < fields.size(); ++i) {
        text += "  " + fields[i].text;
        const auto writer = std::find_if(writers.begin(), writers.end(),
                                         [&](const FieldWriter& one) { return one.field == i; });
        if (!fields[i].is_committed) {
            text += "   # not committed";
        } else if (writer != writers.end()) {
            text +=
                "   # " + in_quotes(writer->name) + ", transaction " + std::to_string(writer->transaction);
        }
        text += "\n";
    }
    return text;
}

}  // namespace

void list_objects(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    if (arguments.empty()) return print_names(dry_run, "*", "*");
    const Word& word = arguments[0];
    const std::size_t slash = word.find('/');
    if (word.part(0, slash).text().find_first_of("*?") != std::string::npos) {
        return print_names(dry_run, word.part(0, slash).text(),
                           slash == Word::None ? "*" : word.part(slash + 1).text());
    }
    print_names(dry_run, kind_word(read_kind(word.part(0, slash))),
                slash == Word::None ? "*" : word.part(slash + 1).text());
}

void find_objects(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    print_names(dry_run, "*", arguments[0].text());
}

void show_tree(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    const ObjectId top = arguments.empty() ? scene::RootId : dry_run.read(arguments[0]);
    dry_run.print(Tree(dry_run).text(top));
}

void show_object(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    const ObjectId id = dry_run.read(arguments[0]);
    const scene::Scene& scene = dry_run.scene();
    const scene::Object& object = *scene.find(id);
    const ObjectKind kind = scene::kind(object);
    const scene::FieldMask uncommitted = dry_run.uncommitted_fields(id);
    std::vector<ShownField> fields;
    for (const unsigned field : fields_of(kind)) {
        const std::string name(scene::field_name(kind, field));
        fields.push_back({name + std::string(name.size() < 27 ? 28 - name.size() : 1, ' ') +
                              value_text(object, field, [&](ObjectId to) { return dry_run.path(to); }),
                          ((uncommitted >> field) & 1u) == 0});
    }
    const std::string title = dry_run.path_index().full_path(scene, id);
    // Only the master knows the writers, so it is asked when the line is executed.
    const bool is_new = uncommitted == ~scene::FieldMask{0};
    dry_run.add_action([title, fields, id, is_new](EditTarget& target) -> Expected<std::string> {
        if (is_new) return shown(title, fields, {});
        const auto writers = target.writers(id);
        if (!writers) return tl::unexpected<Error>(writers.error());
        return shown(title, fields, *writers);
    });
}

}  // namespace tessera::edit
