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
    std::string text;          // what it did, for people; of a drag, what its last edit did
    std::vector<ObjectId> objects;
};

struct SessionLog {
    std::vector<LoggedTransaction> transactions;  // oldest first
    std::vector<std::string> notes;               // what could not be read
};

// What a session's folder tells: the journal, and the transactions of the oldest checkpoint where the journal
// before that is gone. Changes
// nothing, and takes an end that is just being written for the end. `object`: only what touched it, by its
// number or as materials/red, if that was its name at any time; "" = all. Throws Error{Io} when there is no
// such folder.
SessionLog read_session_log(const std::filesystem::path& folder, const std::string& object);

}  // namespace tessera::master
