#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace tessera::tools {

enum class Severity { Ok, Warning, Error };  // Warning: usable with limits; Error: Tessera does not work here

struct Fact {
    std::string key;  // snake_case with its unit: "shared_memory_bytes"
    std::variant<bool, std::uint64_t, std::string> value;
};

// One check of `tessera doctor` and its result.
struct Diagnostic {
    Severity severity = Severity::Ok;
    std::string subject, fact;
    std::string remedy;       // "" = none needed
    std::vector<Fact> facts;  // details; may be empty
};
using Diagnostics = std::vector<Diagnostic>;

std::string byte_text(std::uint64_t bytes);  // "128 B", "32.0 KiB", "1.5 GiB"

void print(const Diagnostics& diagnostics);
void print_json(const Diagnostics& diagnostics);

}  // namespace tessera::tools
