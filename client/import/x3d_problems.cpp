#include "client/import/x3d_problems.h"

#include <algorithm>

namespace tessera::import {
namespace {

constexpr std::size_t MostKinds = 64;
constexpr std::size_t LongestKind = 300;

}  // namespace

void X3dProblems::count(Kinds& kinds, const std::string& kind, std::ptrdiff_t offset) {
    const std::string named = kind.substr(0, LongestKind);
    if (kinds.size() >= MostKinds && !kinds.contains(named)) {
        ++others_;
        return;
    }
    Times& times = kinds[named];
    if (times.count++ == 0) times.first = offset;
}

void X3dProblems::add(const std::string& problem, std::ptrdiff_t offset) {
    count(problems_, problem, offset);
}

void X3dProblems::skipped(const std::string& node, std::ptrdiff_t offset) {
    count(skipped_, node, offset);
}

std::string X3dProblems::line(std::ptrdiff_t offset) const {
    const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ptrdiff_t(text_.size()));
    return "line " + std::to_string(1 + std::count(text_.begin(), end, '\n'));
}

std::vector<std::string> X3dProblems::notices() const {
    std::vector<std::string> notices;
    const auto place = [&](const Times& times) {
        const std::string more = times.count > 1 ? " and " + std::to_string(times.count - 1) + " more" : "";
        return " (" + line(times.first) + more + ")";
    };
    for (const auto& [problem, times] : problems_) notices.push_back(problem + place(times));
    for (const auto& [node, times] : skipped_)
        notices.push_back("<" + node + "> skipped: not read, or not in such a place" + place(times));
    if (others_ > 0) notices.push_back(std::to_string(others_) + " other problems of the file");
    return notices;
}

std::string X3dProblems::skipped() const {
    constexpr std::size_t Most = 5;
    std::string text;
    std::size_t shown = 0;
    for (const auto& [node, times] : skipped_) {
        if (shown++ < Most)
            text += (text.empty() ? "" : ", ") + std::to_string(times.count) + " <" + node + ">";
    }
    return text + (shown > Most ? " and others" : "");
}

}  // namespace tessera::import
