#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/fuzz/decoders/decoder.h"

// The entry points that libFuzzer calls. It ignores the options of this program, which begin with two dashes.
namespace {

using namespace tessera;

const fuzz::Decoder* chosen = nullptr;

void list() {
    for (const fuzz::Decoder& decoder : fuzz::decoders()) std::puts(decoder.name);
}

void write_seeds(const std::filesystem::path& folder) {
    if (chosen->seeds == nullptr) return;
    int number = 0;
    for (const auto& seed : chosen->seeds()) {
        std::ofstream out(folder / ("seed-" + std::to_string(++number)), std::ios::binary);
        out.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
        fuzz::require(out.flush().good(), "a seed cannot be written to " + folder.string());
    }
}

[[noreturn]] void explain_usage() {
    std::fputs(
        "Usage: fuzz_decoders --list\n"
        "       fuzz_decoders --decoder=NAME --seeds=FOLDER   writes the seeds that are not in the tree\n"
        "       fuzz_decoders --decoder=NAME FILE...          decodes these files\n"
        "       fuzz_decoders --decoder=NAME [libFuzzer's options] FOLDER...   -help=1 lists them\n",
        stderr);
    std::exit(64);
}

}  // namespace

// assimp 5.2 leaks when it refuses a file. It runs in a process of its own, which ends then.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libassimp.so";
}

extern "C" int LLVMFuzzerInitialize(const int* count, char*** words) {
    std::string seeds_folder;
    for (int i = 1; i < *count; ++i) {
        const std::string_view word = (*words)[i];
        if (word == "--list") {
            list();
            std::exit(0);
        }
        if (word.starts_with("--decoder=")) chosen = fuzz::decoder_named(word.substr(10));
        if (word.starts_with("--seeds=")) seeds_folder = word.substr(8);
    }
    if (chosen == nullptr) explain_usage();
    if (seeds_folder.empty()) return 0;
    write_seeds(seeds_folder);
    std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    chosen->decode(std::as_bytes(std::span(data, size)));
    return 0;
}
