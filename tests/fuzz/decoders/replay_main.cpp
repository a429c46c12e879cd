#include <algorithm>
#include <cstdio>
#include <string>

#include "tests/fuzz/decoders/decoder.h"
#include "tests/support/folders.h"

// Decodes the corpus, or given files, as the fuzzers do, in a build of any compiler.
namespace tessera::fuzz {

namespace {

// The name comes first, so that it is the last line when a decoder crashes.
void replay(const Decoder& decoder, const std::string& name, Bytes bytes) {
    std::printf("%s %s\n", decoder.name, name.c_str());
    std::fflush(stdout);
    decoder.decode(bytes);
}

void replay_all(const Decoder& decoder, const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    if (std::filesystem::exists(folder)) {
        for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
    }
    std::ranges::sort(files);
    const Seeds seeds = decoder.seeds != nullptr ? decoder.seeds() : Seeds{};
    require(!files.empty() || !seeds.empty(), std::string("no seeds for ") + decoder.name);
    for (std::size_t i = 0; i < seeds.size(); ++i) replay(decoder, "seed " + std::to_string(i + 1), seeds[i]);
    for (const auto& file : files) replay(decoder, file.string(), content_of(file));
    replay(decoder, "nothing", {});
}

int run(const std::vector<std::string>& words) {
    const std::filesystem::path corpus = test::source_folder() / "tests/fuzz/decoders/corpus";
    if (words.empty()) {
        for (const auto& folder : std::filesystem::directory_iterator(corpus))
            require(decoder_named(folder.path().filename().string()) != nullptr,
                    "no decoder for the folder " + folder.path().string());
        for (const Decoder& decoder : decoders()) replay_all(decoder, corpus / decoder.name);
        return 0;
    }
    const Decoder* decoder = decoder_named(words[0]);
    if (decoder == nullptr) {
        std::fputs(
            "Usage: replay_decoders [DECODER [FILE...]]\nDecodes these files, or the corpus. DECODER is one "
            "of:",
            stderr);
        for (const Decoder& one : decoders()) std::fprintf(stderr, " %s", one.name);
        std::fputs("\n", stderr);
        return 64;
    }
    if (words.size() == 1) replay_all(*decoder, corpus / decoder->name);
    for (std::size_t i = 1; i < words.size(); ++i) replay(*decoder, words[i], content_of(words[i]));
    return 0;
}

}  // namespace

}  // namespace tessera::fuzz

int main(int count, char** words) {
    return tessera::fuzz::run({words + 1, words + count});
}
