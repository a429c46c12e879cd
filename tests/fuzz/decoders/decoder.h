#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/error.h"

// What reads bytes that others have made, and how to show it any of them.
namespace tessera::fuzz {

using Bytes = std::span<const std::byte>;
using Seeds = std::vector<std::vector<std::byte>>;

// `decode` returns, whatever the bytes are. It ends the process when a promise is broken; other exceptions than the
// documented Error, crashes, leaks, and a memory or time that does not fit the bytes are findings, too.
struct Decoder {
    const char* name;
    void (*decode)(Bytes);
    Seeds (*seeds)() = nullptr;  // in addition to the files of corpus/NAME
};
std::span<const Decoder> decoders();
const Decoder* decoder_named(std::string_view name);  // null: there is none

// Parts of decoders(), one per source.
std::vector<Decoder> message_decoders();
std::vector<Decoder> session_decoders();
std::vector<Decoder> scene_decoders();
std::vector<Decoder> picture_decoders();
std::vector<Decoder> display_decoders();
std::vector<Decoder> text_decoders();

// Ends the process with the text if the promise is broken.
void require(bool promise, const std::string& otherwise);

// An error has a text, and does not say that it is a bug.
void require_reason(const Error& error);

// Whether `decode` returned; otherwise it threw an Error with a reason.
bool accepts(const std::function<void()>& decode);

std::string_view text_of(Bytes bytes);
std::vector<std::byte> bytes_of(std::string_view text);

// A file of these bytes in the folder of this process, for decoders that only read files; the next one of the same name
// replaces it.
std::filesystem::path file_of(const std::string& name, Bytes bytes);
std::vector<std::byte> content_of(const std::filesystem::path& file);

}  // namespace tessera::fuzz
