#include "tests/fuzz/faults.h"

#include <sys/resource.h>

#include <csignal>

#include "master/scene/session_folder.h"

namespace tessera::test {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t LongFault = 1'000'000;  // until heal()

void limit_files(rlim_t bytes) {
    rlimit limit{};
    ::getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = std::min(bytes, limit.rlim_max);
    ::setrlimit(RLIMIT_FSIZE, &limit);
}

}  // namespace

void Faults::step(LinkSwitch& one, LinkSwitch& other) {
    if (left_ > 0 && --left_ == 0) heal();
    if (left_ > 0 || random_.below(400) != 0) return;
    ++count_;
    left_ = random_.chance(30) ? LongFault : 50 + random_.below(500);
    LinkSwitch& link = random_.chance(50) ? one : other;
    switch (random_.below(5)) {
        case 0:
        case 1:
            stalled_ = &link;
            return link.stall_bulk(true);
        case 2:
            return link.cut();  // until its node has noticed
        default:
            return fill_disk();
    }
}

void Faults::heal() {
    left_ = 0;
    if (stalled_ != nullptr) stalled_->stall_bulk(false);
    stalled_ = nullptr;
    if (disk_changes_ % 2 == 1) empty_disk();
}

// The limit of this process stands for free space: records are cut anywhere.
void Faults::fill_disk() {
    std::signal(SIGXFSZ, SIG_IGN);
    const auto journals = master::session_files(folder_).journals;
    if (journals.empty()) return;
    std::error_code error;
    const std::uintmax_t size = fs::file_size(master::journal_path(folder_, journals.back()), error);
    ++disk_changes_;
    limit_files(error ? 0 : size + random_.below(300));
}

void Faults::empty_disk() {
    limit_files(RLIM_INFINITY);
    ++disk_changes_;
}

}  // namespace tessera::test
