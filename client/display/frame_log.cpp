#include "client/display/frame_log.h"

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "mediator/base/error.h"

namespace tessera::client_display {

FrameLog::FrameLog(const std::string& path) : file_(std::fopen(path.c_str(), "a")) {
    if (!file_) throw Error(ErrorCode::Io, path + " cannot be written: " + std::strerror(errno));
}

void FrameLog::add(const Line& line) {
    if (!file_) return;
    const nlohmann::json object{{"output", line.output},
                                {"frame", line.frame},
                                {"epoch", line.version.epoch},
                                {"version", line.version.number},
                                {"at", line.at},
                                {"shown", line.shown},
                                {"bound", line.bound},
                                {"samples", line.samples}};
    // Written at once and flushed, so that it is complete if the process is killed.
    std::fputs((object.dump() + "\n").c_str(), file_.get());
    std::fflush(file_.get());
}

}  // namespace tessera::client_display
