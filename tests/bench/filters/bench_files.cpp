#include "tests/bench/filters/bench_files.h"

#include <span>

#include "mediator/base/error.h"
#include "mediator/picture/atomic_file.h"
#include "tests/bench/filters/html_report.h"
#include "tests/bench/filters/json_report.h"
#include "tests/bench/filters/strip.h"

namespace tessera::tools::bench {

BenchFiles::BenchFiles(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) {
        throw Error(ErrorCode::Io, "cannot create the folder '" + folder_.string() + "': " + error.message());
    }
}

std::vector<std::string> BenchFiles::write(const BenchResults& results) const {
    std::vector<std::string> written;
    const auto write_file = [&](const char* name, std::string_view content) {
        const std::string path = (folder_ / name).string();
        picture::write_atomically(path, content);
        written.push_back(path);
    };
    write_file("filters.json", as_json(results) + "\n");
    write_file("filters.html", as_html(results));
    const Strip strip = make_strip(results);
    if (!strip.png.empty()) {
        write_file("crops.png", {reinterpret_cast<const char*>(strip.png.data()), strip.png.size()});
        write_file("crops.md", strip.table);
    }
    return written;
}

}  // namespace tessera::tools::bench
