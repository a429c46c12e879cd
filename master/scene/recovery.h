#pragma once

#include <string>
#include <vector>

#include "master/scene/scene_authority.h"
#include "master/scene/session_folder.h"

namespace tessera::master {

struct Recovery {
    bool found = false;         // there was a session: the authority has it
    wire::RecordedTitle scene;  // no title: none was open
    std::vector<wire::SavedView> views;
    std::uint64_t edits = 0;         // done again from the journal
    std::uint64_t next_segment = 1;  // for the Journal
    std::vector<std::string> notes;  // for the log: what was used, what was torn or damaged, what is missing
};

// Brings a fresh authority to what the folder's session was: the newest checkpoint that is good, and all that
// was recorded after it. A record that its master's death tore is cut off; at one that is damaged it ends.
// What is cut off or of no use is kept under another name (.tail-OFFSET, .damaged). Blobs that the scene or
// its history refer to go into the store. Throws Error when nothing can be recovered though something was
// there.
Recovery recover(const SessionFolder& folder, SceneAuthority& authority, scene::BlobStore& blobs);

}  // namespace tessera::master
