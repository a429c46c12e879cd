#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>

#include "client/edit/command_functions.h"
#include "client/edit/graph.h"
#include "client/edit/script_error.h"
#include "client/export/export.h"
#include "client/import/import.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/references.h"

namespace tessera::edit {
namespace {

bool has_camera(const scene::Scene& scene) {
    return std::any_of(scene.objects().begin(), scene.objects().end(), [](const auto& entry) {
        return std::holds_alternative<scene::Camera>(*entry.second);
    });
}

// The background of the file and the textures used only by it.
std::set<ObjectId> background_objects(const import::ImportedScene& imported) {
    std::map<ObjectId, const scene::Object*> objects;
    std::map<ObjectId, std::size_t> users;
    for (const scene::Create& create : imported.objects) {
        objects[create.id] = &create.object;
        scene::for_each_reference(create.object, [&](ObjectId to) { ++users[to]; });
    }
    std::set<ObjectId> alone;
    if (const ObjectId background = imported.root.background) {
        alone.insert(background);
        scene::for_each_reference(*objects.at(background), [&](ObjectId to) {
            if (to && users[to] == 1) alone.insert(to);
        });
    }
    return alone;
}

// "at=SECONDS".
double seconds_of(const Word& word) {
    constexpr std::string_view Name = "at=";
    const std::string& text = word.text();
    double seconds = 0.0;
    if (text.starts_with(Name)) {
        const char* const end = text.data() + text.size();
        const auto [last, error] = std::from_chars(text.data() + Name.size(), end, seconds);
        if (error == std::errc{} && last == end && std::isfinite(seconds)) return seconds;
    }
    throw ScriptError(word.column(), "'" + text +
                                         "' is not an animation time: write at=SECONDS, like at=1.5 "
                                         "(quote file names that contain blanks)");
}

}  // namespace

void load_file(DryRun& dry_run, const Arguments& given, std::size_t end) {
    Arguments arguments = given;
    const auto parent_path = take_keyword(arguments, "in", end);
    if (arguments.empty()) throw ScriptError(end, "'load' needs a file");
    const ObjectId parent = parent_path ? read_parent(dry_run, *parent_path) : scene::RootId;
    const std::filesystem::path file = arguments[0].text();
    import::ImportOptions options;
    // Missing cameras and lights are added only to an empty scene.
    if (has_camera(dry_run.scene())) options.missing = import::Missing::Leave;
    if (arguments.size() > 1) options.at = seconds_of(arguments[1]);
    auto imported = import::import_scene(file, options);
    if (!imported) throw ScriptError(arguments[0].column(), imported.error().what());

    const scene::Root root = *dry_run.scene().find_as<scene::Root>(scene::RootId);
    const std::set<ObjectId> skipped = root.background ? background_objects(*imported) : std::set<ObjectId>();
    std::map<ObjectId, ObjectId> ids{{ObjectId{}, ObjectId{}}};
    for (const scene::Create& create : imported->objects) {
        if (!skipped.contains(create.id)) ids[create.id] = new_id(dry_run);
    }
    std::vector<scene::Entry> entries;
    std::set<Hash256> wanted;
    for (scene::Create& create : imported->objects) {
        if (skipped.contains(create.id)) continue;
        scene::for_each_reference(create.object, [&](ObjectId& to) { to = ids.at(to); });
        for (const scene::BlobRef& blob : scene::referenced_blobs(create.object)) wanted.insert(blob.hash);
        entries.emplace_back(scene::Create{ids.at(create.id), std::move(create.object)});
    }
    scene::Transform top{.name = file.stem().string()};
    for (const ObjectId child : imported->root.children) top.children.push_back(ids.at(child));
    const ObjectId top_id = new_id(dry_run);
    entries.emplace_back(scene::Create{top_id, std::move(top)});
    scene::Object above = *dry_run.scene().find(parent);
    children_of(above).push_back(top_id);
    scene::Update update = std::get<scene::Update>(children_update(parent, std::move(above)));
    if (!root.background && imported->root.background) {
        scene::Root with_background = root;
        if (parent == scene::RootId) with_background = std::get<scene::Root>(update.fields);
        with_background.background = ids.at(imported->root.background);
        using Fields = scene::Fields<scene::Root>;
        const scene::FieldMask mask = Fields(&scene::Root::background).bits();
        if (parent == scene::RootId) {
            update = {scene::RootId, update.mask | mask, std::move(with_background)};
        } else {
            entries.emplace_back(scene::Update{scene::RootId, mask, std::move(with_background)});
        }
    }
    entries.emplace_back(std::move(update));
    dry_run.apply(entries);
    std::erase_if(imported->blobs,
                  [&](const scene::BlobPtr& blob) { return !wanted.contains(blob->hash()); });
    dry_run.add_blobs(imported->blobs);

    std::string text = dry_run.path(top_id) + ": " + std::to_string(imported->counts.triangles) +
                       " triangles in " + std::to_string(imported->counts.geometries) + " geometries\n";
    for (const std::string& notice : imported->notices) text += "  " + notice + "\n";
    if (!skipped.empty()) text += "  the file's background was skipped: the scene already has one\n";
    dry_run.print(std::move(text));
}

void save_file(DryRun& dry_run, const Arguments& arguments, std::size_t) {
    const std::filesystem::path file = arguments[0].text();
    if (const std::string extension = file.extension().string();
        extension != ".glb" && extension != ".tessera") {
        throw ScriptError(arguments[0].column(), "'" + file.string() + "' must end in .glb or .tessera");
    }
    const scene::Scene scene = dry_run.scene();
    std::vector<scene::BlobPtr> pending;
    for (const scene::BlobRef& reference : scene::referenced_blobs(scene)) {
        if (auto blob = dry_run.pending_blob(reference.hash)) pending.push_back(std::move(blob));
    }
    dry_run.add_action([file, scene, pending](EditTarget& target) -> Expected<std::string> {
        scene::BlobStore blobs;
        for (const scene::BlobPtr& blob : pending) blobs.insert(blob);
        for (const scene::BlobRef& reference : scene::referenced_blobs(scene)) {
            if (blobs.find(reference.hash)) continue;
            const auto blob = target.blob(reference);
            if (!blob) return tl::unexpected<Error>(blob.error());
            blobs.insert(*blob);
        }
        const auto written = exporting::write_scene(scene, blobs, file);
        if (!written) return tl::unexpected<Error>(written.error());
        std::string text = "saved '" + file.string() + "'\n";
        for (const std::string& notice : *written) text += "  " + notice + "\n";
        return text;
    });
}

}  // namespace tessera::edit
