#pragma once

#include <string>
#include <vector>

#include "master/scene/scene_authority.h"
#include "master/scene/session_folder.h"

namespace tessera::master {

struct Recovery {
    bool found = false;         // a session was found and restored into the authority
    wire::RecordedTitle scene;  // no title: no scene was open
    std::vector<wire::SavedView> views;
    std::uint64_t edits = 0;          // replayed from the journal
    std::uint64_t next_segment = 1;   // for the Journal
    std::vector<std::string> notes;   // for the log: what was used
    std::vector<std::string> losses;  // what is damaged, missing or given up
};

// Restores the folder's session into a new authority: the newest valid checkpoint, then the journal after it. An
// incomplete last record (from a crash) is cut off; a damaged record ends the replay. Unusable data is kept under
// another name (.tail-OFFSET, .damaged). Blobs that the scene or its history refer to are put into the store. Throws
// Error if there is a session but nothing of it can be recovered.
Recovery recover(const SessionFolder& folder, SceneAuthority& authority, scene::BlobStore& blobs);

}  // namespace tessera::master
