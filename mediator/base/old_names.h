#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

// Documented names of version 0.1 and what replaced them. Version 0.2 still accepts them, with a hint; 0.3 will not.
struct OldName {
    std::string_view kind, old_name, name;
};
inline constexpr std::array OldNames{
    OldName{"command", "audience", "preview"},
    OldName{"option", "--of", "--owner"},
    OldName{"edit command", "people", "members"},
    OldName{"filter parameter", "fade", "blend"},
    OldName{"filter parameter", "light_fade", "light_history"},
    OldName{"filter parameter", "young", "min_history"},
    OldName{"channel", "range", "headlight"},
    OldName{"channel", "even_half", "half_buffer_a"},
    // Of JSON objects, which have both.
    OldName{"key", "share", "fraction"},
    OldName{"key", "units_in_hand", "units_in_flight"},
    OldName{"key", "verdict", "severity"},
    OldName{"key", "least", "minimum"},
    OldName{"key", "most", "maximum"},
};

// The present name; nothing if `name` was never one of the kind's.
constexpr std::optional<std::string_view> present_name(std::string_view kind, std::string_view name) {
    for (const OldName& entry : OldNames) {
        if (entry.kind == kind && entry.old_name == name) return entry.name;
    }
    return std::nullopt;
}
constexpr std::optional<std::string_view> old_name(std::string_view kind, std::string_view name) {
    for (const OldName& entry : OldNames) {
        if (entry.kind == kind && entry.name == name) return entry.old_name;
    }
    return std::nullopt;
}

inline std::string old_name_hint(std::string_view old, std::string_view present) {
    return "'" + std::string(old) + "' is now '" + std::string(present) +
           "'; the old name goes away with the next version";
}

}  // namespace tessera
