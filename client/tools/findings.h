#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace tessera::tools {

enum class Verdict { Good, Poor, Bad };  // Poor: some uses suffer; Bad: something does not work here at all

struct Fact {
    std::string key;  // snake_case with its unit: "shared_memory_bytes"
    std::variant<bool, std::uint64_t, std::string> value;
};

// What `tessera doctor` found out about one thing.
struct Finding {
    Verdict verdict = Verdict::Good;
    std::string subject, fact;
    std::string remedy;       // "" = none needed
    std::vector<Fact> facts;  // more, where there is more to know
};
using Findings = std::vector<Finding>;

std::string byte_text(std::uint64_t bytes);  // "128 B", "32.0 KiB", "1.5 GiB"

void print(const Findings& findings);
void print_json(const Findings& findings);

}  // namespace tessera::tools
