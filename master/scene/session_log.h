#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mediator/base/ids.h"

namespace tessera::master {

struct LoggedTransaction {
    std::uint64_t number = 0;
    std::string name, user;  // user: of the key
    std::int64_t time = 0;   // ns since 1970, of the last edit
    std::uint64_t edits = 0;
    std::uint64_t undoes = 0;  // a number; 0 = none
    std::string text;          // readable summary; of a drag, of its last edit
    std::vector<ObjectId> objects;
};

struct SessionLog {
    std::vector<LoggedTransaction> transactions;  // oldest first
    std::vector<std::string> notes;               // what could not be read
};

// Reads the history of a session folder: the journal, and the transactions of the oldest checkpoint where the journal
// before it was removed. Changes nothing; a record that is just being written counts as the end. `object`: only
// transactions that touched it, by its number or a name it had at any time, as in materials/red; "" = all. Throws
// Error{Io} if the folder does not exist.
SessionLog read_session_log(const std::filesystem::path& folder, const std::string& object);

}  // namespace tessera::master
