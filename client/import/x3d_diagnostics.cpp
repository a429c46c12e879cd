#include "client/import/x3d_diagnostics.h"

#include <algorithm>

namespace tessera::import {
namespace {

constexpr std::size_t MostKinds = 64;
constexpr std::size_t LongestKind = 300;

}  // namespace

void X3dDiagnostics::count(Kinds& kinds, const std::string& kind, std::ptrdiff_t offset) {
    const std::string named = kind.substr(0, LongestKind);
    if (kinds.size() >= MostKinds && !kinds.contains(named)) {
        ++overflow_;
        return;
    }
    Occurrences& occurrences = kinds[named];
    if (occurrences.count++ == 0) occurrences.first = offset;
}

void X3dDiagnostics::add(const std::string& problem, std::ptrdiff_t offset) {
    count(diagnostics_, problem, offset);
}

void X3dDiagnostics::skipped(const std::string& node, std::ptrdiff_t offset) {
    count(skipped_, node, offset);
}

std::string X3dDiagnostics::line(std::ptrdiff_t offset) const {
    const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ptrdiff_t(text_.size()));
    return "line " + std::to_string(1 + std::count(text_.begin(), end, '\n'));
}

std::vector<std::string> X3dDiagnostics::notices() const {
    std::vector<std::string> notices;
    const auto location = [&](const Occurrences& occurrences) {
        const std::string more =
            occurrences.count > 1 ? " and " + std::to_string(occurrences.count - 1) + " more" : "";
        return " (" + line(occurrences.first) + more + ")";
    };
    for (const auto& [problem, occurrences] : diagnostics_)
        notices.push_back(problem + location(occurrences));
    for (const auto& [node, occurrences] : skipped_)
        notices.push_back("<" + node + "> skipped: unsupported, or not supported in this place" +
                          location(occurrences));
    if (overflow_ > 0) notices.push_back(std::to_string(overflow_) + " other problems in the file");
    return notices;
}

std::string X3dDiagnostics::skipped() const {
    constexpr std::size_t Most = 5;
    std::string text;
    std::size_t shown = 0;
    for (const auto& [node, occurrences] : skipped_) {
        if (shown++ < Most)
            text += (text.empty() ? "" : ", ") + std::to_string(occurrences.count) + " <" + node + ">";
    }
    return text + (shown > Most ? " and others" : "");
}

}  // namespace tessera::import
