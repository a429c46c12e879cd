#include "client/edit/completion.h"

#include <algorithm>
#include <filesystem>

#include "client/edit/commands.h"
#include "client/edit/help.h"
#include "client/edit/path_index.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "mediator/scene/fields.h"

namespace tessera::edit {
namespace {

namespace fs = std::filesystem;
using scene::ObjectKind;

constexpr std::size_t MaxCandidates = 1000;

class Completer {
  public:
    Completer(std::string_view before, const scene::Scene& scene) : scene_(scene), path_index_(scene) {
        SplitLine line = split_lenient(before);
        words_ = std::move(line.words);
        if (words_.empty() || !line.ends_with_word) words_.emplace_back();
        // Start of the word at the cursor: after the last blank outside of quotes.
        begin_ = before.size();
        if (line.ends_with_word && !words_.empty()) begin_ = start_of_last_word(before);
        start_ = std::string(before.substr(begin_));
    }

    Completion run() {
        const std::size_t index = words_.size() - 1;
        if (index == 0) {
            for (const Command& command : commands()) add_candidate(std::string(command.name) + " ");
        } else if (const Command* command = find_command(words_[0].text())) {
            argument(*command, index - 1);
        }
        std::sort(found_.begin(), found_.end());
        found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
        return {begin_, std::move(found_)};
    }

  private:
    static std::size_t start_of_last_word(std::string_view text) {
        std::size_t start = 0;
        bool inside = false;
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] == '\\') {
                ++i;
            } else if (text[i] == '"') {
                inside = !inside;
            } else if (!inside && (text[i] == ' ' || text[i] == '\t')) {
                start = i + 1;
            }
        }
        return start;
    }

    void add_candidate(std::string candidate) {
        if (candidate.starts_with(start_) && found_.size() < MaxCandidates)
            found_.push_back(std::move(candidate));
    }

    void argument(const Command& command, std::size_t index) {
        if (!command.keyword.empty() && index > 0 && words_[index].is(command.keyword)) {
            paths(ObjectKind::Transform, " ");
            return add_candidate("root ");
        }
        if (!command.keyword.empty() && index >= command.min_arguments)
            add_candidate(std::string(command.keyword) + " ");
        if (command.arguments.empty() || index >= command.max_arguments) return;
        const Argument kind = command.arguments[std::min(index, command.arguments.size() - 1)];
        switch (kind) {
            case Argument::Path:
                add_candidate("root ");
                return all_paths(" ");
            case Argument::Transform:
                return paths(ObjectKind::Transform, " ");
            case Argument::Field:
                return fields();
            case Argument::Value:
                return value();
            case Argument::Kind:
                for (const scene::KindRow& row : scene::Kinds) {
                    if (row.kind != ObjectKind::Root) add_candidate(std::string(row.name) + " ");
                }
                return;
            case Argument::KindOrPath:
                for (const std::string& word : kind_words()) add_candidate(word + " ");
                return all_paths(" ");
            case Argument::Assignments:
                return assignments();
            case Argument::File:
                return files({".gltf", ".glb", ".obj", ".ply", ".stl", ".tessera", ".x3d"});
            case Argument::SaveFile:
                return files({".glb", ".tessera"});
            case Argument::Topic:
                for (const Command& one : commands()) add_candidate(std::string(one.name) + " ");
                for (const std::string& word : kind_words()) add_candidate(word + " ");
                for (const std::string& word : help_topics()) add_candidate(word + " ");
                return;
            case Argument::NewName:
            case Argument::Free:
                return;
        }
    }

    void paths(ObjectKind kind, const std::string& end, const std::string& before = {}) {
        for (const auto& [name, ids] : path_index_.names(kind)) {
            for (const ObjectId id : ids) add_candidate(before + path_index_.path(scene_, id) + end);
            if (found_.size() >= MaxCandidates) return;
        }
    }

    // Of all objects but the root. Kinds first, so that a scene of a million objects is not listed at once.
    void all_paths(const std::string& end, const std::string& before = {}) {
        for (const scene::KindRow& row : scene::Kinds) {
            const std::string prefix = before + row.plural + "/";
            if (row.kind == ObjectKind::Root) continue;
            if (start_.starts_with(prefix)) {
                paths(row.kind, end, before);
            } else if (!path_index_.names(row.kind).empty()) {
                add_candidate(prefix);
            }
        }
    }

    void fields() {
        const Word& word = words_.back();
        // After any dot that follows the path of an object: names may contain dots.
        for (std::size_t dot = word.find('.'); dot != Word::None; dot = word.find('.', dot + 1)) {
            const ObjectId id = object_of(word.part(0, dot));
            if (!id) continue;
            const std::size_t shown = start_.rfind('.');
            const std::string path = start_.substr(0, shown + 1);
            field_words(scene::kind(*scene_.find(id)), path, " ");
        }
        add_candidate("root.");
        all_paths(".");
    }

    void field_words(ObjectKind kind, const std::string& before, const std::string& end) {
        for (const unsigned field : fields_of(kind)) {
            if (value_form(kind, field).is_settable)
                add_candidate(before + std::string(scene::field_name(kind, field)) + end);
        }
        if (kind == ObjectKind::Material) add_candidate(before + "diffuse" + end);
    }

    ObjectId object_of(const Word& path) const {
        try {
            return path_index_.read(scene_, path);
        } catch (const ScriptError&) {
            return {};
        }
    }

    void value() {
        const Word& target = words_[1];
        const std::size_t dot = target.rfind('.');
        if (dot == Word::None) return;
        const ObjectId id = object_of(target.part(0, dot));
        if (!id) return;
        const ObjectKind kind = scene::kind(*scene_.find(id));
        if (const auto field = find_field(kind, target.part(dot + 1).text()))
            value_of(value_form(kind, *field), "", " ");
    }

    void value_of(const ValueForm& form, const std::string& before, const std::string& end) {
        for (const std::string& word : form.words)
            add_candidate(before + word + (word.ends_with('=') ? "" : end));
        if (form.takes_paths) all_paths(end, before);
    }

    void assignments() {
        ObjectKind kind{};
        if (!is_kind(words_[1].text(), kind)) return;
        const std::size_t equals = start_.find('=');
        if (equals == std::string::npos) return field_words(kind, "", "=");
        if (const auto field = find_field(kind, start_.substr(0, equals)))
            value_of(value_form(kind, *field), start_.substr(0, equals + 1), " ");
    }

    void files(const std::vector<std::string>& endings) {
        const fs::path typed = words_.back().text();
        const fs::path folder = typed.parent_path();
        std::error_code error;
        fs::directory_iterator entries(folder.empty() ? fs::path(".") : folder, error);
        for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
            const std::string name = (folder / entries->path().filename()).string();
            if (!name.starts_with(words_.back().text())) continue;
            std::error_code unreadable;
            const bool is_folder = entries->is_directory(unreadable);
            const bool fits =
                std::find(endings.begin(), endings.end(), entries->path().extension()) != endings.end();
            // Quoting changes the start of the word, so the typed text need not be a prefix any more.
            if (is_folder) found_.push_back(unclosed(in_quotes(name + "/")));
            if (!is_folder && fits) found_.push_back(in_quotes(name) + " ");
            if (found_.size() >= MaxCandidates) return;
        }
    }
    static std::string unclosed(std::string text) {
        if (text.ends_with('"')) text.pop_back();
        return text;
    }

    const scene::Scene& scene_;
    PathIndex path_index_;
    std::vector<Word> words_;
    std::size_t begin_ = 0;
    std::string start_;
    std::vector<std::string> found_;
};

}  // namespace

Completion complete(std::string_view text, std::size_t cursor, const scene::Scene& scene) {
    return Completer(text.substr(0, std::min(cursor, text.size())), scene).run();
}

}  // namespace tessera::edit
