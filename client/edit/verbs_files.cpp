#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>

#include "client/edit/graph.h"
#include "client/edit/script_error.h"
#include "client/edit/verbs.h"
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

// The file's background, and the textures that only it uses.
std::set<ObjectId> background_alone(const import::ImportedScene& imported) {
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
    throw ScriptError(word.column(),
                      "'" + text +
                          "' is no time of the file's animations: write at=SECONDS, like at=1.5 "
                          "(a name with blanks goes into quotes)");
}

}  // namespace

void load_file(Rehearsal& rehearsal, const Arguments& given, std::size_t end) {
    Arguments arguments = given;
    const auto parent_path = take_keyword(arguments, "in", end);
    if (arguments.empty()) throw ScriptError(end, "'load' takes a file");
    const ObjectId parent = parent_path ? read_parent(rehearsal, *parent_path) : scene::RootId;
    const std::filesystem::path file = arguments[0].text();
    import::ImportOptions options;
    // An empty scene is to be seen; another one has its cameras and its light.
    if (has_camera(rehearsal.scene())) options.missing = import::Missing::Leave;
    if (arguments.size() > 1) options.at = seconds_of(arguments[1]);
    auto imported = import::import_scene(file, options);
    if (!imported) throw ScriptError(arguments[0].column(), imported.error().what());

    const scene::Root root = *rehearsal.scene().find_as<scene::Root>(scene::RootId);
    const std::set<ObjectId> left_out = root.background ? background_alone(*imported) : std::set<ObjectId>();
    std::map<ObjectId, ObjectId> ids{{ObjectId{}, ObjectId{}}};
    for (const scene::Create& create : imported->objects) {
        if (!left_out.contains(create.id)) ids[create.id] = new_id(rehearsal);
    }
    std::vector<scene::Entry> entries;
    std::set<Hash256> wanted;
    for (scene::Create& create : imported->objects) {
        if (left_out.contains(create.id)) continue;
        scene::for_each_reference(create.object, [&](ObjectId& to) { to = ids.at(to); });
        for (const scene::BlobRef& blob : scene::referenced_blobs(create.object)) wanted.insert(blob.hash);
        entries.emplace_back(scene::Create{ids.at(create.id), std::move(create.object)});
    }
    scene::Transform top{.name = file.stem().string()};
    for (const ObjectId child : imported->root.children) top.children.push_back(ids.at(child));
    const ObjectId top_id = new_id(rehearsal);
    entries.emplace_back(scene::Create{top_id, std::move(top)});
    scene::Object above = *rehearsal.scene().find(parent);
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
    rehearsal.apply(entries);
    std::erase_if(imported->blobs,
                  [&](const scene::BlobPtr& blob) { return !wanted.contains(blob->hash()); });
    rehearsal.add_blobs(imported->blobs);

    std::string text = rehearsal.path(top_id) + ": " + std::to_string(imported->counts.triangles) +
                       " triangles in " + std::to_string(imported->counts.geometries) + " geometries\n";
    for (const std::string& notice : imported->notices) text += "  " + notice + "\n";
    if (!left_out.empty()) text += "  the file's background is left out: the scene has one\n";
    rehearsal.print(std::move(text));
}

void save_file(Rehearsal& rehearsal, const Arguments& arguments, std::size_t) {
    const std::filesystem::path file = arguments[0].text();
    if (const std::string extension = file.extension().string();
        extension != ".glb" && extension != ".tessera") {
        throw ScriptError(arguments[0].column(),
                          "'" + file.string() + "' ends neither in .glb nor in .tessera: name it so");
    }
    const scene::Scene scene = rehearsal.scene();
    std::vector<scene::BlobPtr> pending;
    for (const scene::BlobRef& reference : scene::referenced_blobs(scene)) {
        if (auto blob = rehearsal.pending_blob(reference.hash)) pending.push_back(std::move(blob));
    }
    rehearsal.act([file, scene, pending](EditTarget& target) -> Expected<std::string> {
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
