#include "mediator/filter/choice.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "mediator/base/old_names.h"

namespace tessera::filter {

namespace {

tl::unexpected<Error> wrong(const std::string& text) {
    return tl::unexpected(Error(ErrorCode::InvalidInput, text));
}

template <class Names>
std::string list(const Names& names) {
    std::string text;
    for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
    return text;
}

std::string number(double value) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value);
    return std::string(buffer, end.ptr);
}

Expected<double> value_of(const Description& filter, const Parameter& parameter, std::string_view text) {
    const std::string name =
        "parameter '" + std::string(parameter.name) + "' of filter '" + std::string(filter.name) + "'";
    if (!parameter.choices.empty()) {
        const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), text);
        if (found == parameter.choices.end()) {
            return wrong(name + " cannot be '" + std::string(text) + "': choose one of " +
                         list(parameter.choices));
        }
        return static_cast<double>(found - parameter.choices.begin());
    }
    double value = 0.0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size() || !std::isfinite(value)) {
        return wrong(name + " needs a number, not '" + std::string(text) + "'");
    }
    if (value < parameter.minimum || value > parameter.maximum) {
        return wrong(name + " is " + number(value) + ": choose a value from " + number(parameter.minimum) +
                     " to " + number(parameter.maximum));
    }
    return value;
}

}  // namespace

Values default_values(const Description& description) {
    Values values;
    for (const Parameter& parameter : description.parameters) values.push_back(parameter.default_value);
    return values;
}

Expected<Choice> parse_choice(std::string_view text, std::span<const FilterEntry> table) {
    const std::size_t colon = text.find(':');
    std::string_view name = text.substr(0, colon);
    if (text.empty()) name = "none";
    const auto entry = std::find_if(table.begin(), table.end(),
                                    [&](const FilterEntry& e) { return e.description.name == name; });
    if (entry == table.end()) {
        std::vector<std::string_view> names;
        for (const FilterEntry& e : table) names.push_back(e.description.name);
        return wrong("there is no filter '" + std::string(name.substr(0, 64)) + "': choose one of " +
                     list(names));
    }
    const Description& filter = entry->description;
    Choice choice{&*entry, default_values(filter)};
    std::string_view rest = colon == std::string_view::npos ? "" : text.substr(colon + 1);
    while (!rest.empty()) {
        const std::string_view item = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(rest.size(), item.size() + 1));
        const std::size_t equals = item.find('=');
        const std::string_view key = item.substr(0, equals);
        const auto& parameters = filter.parameters;
        const auto with_name = [&](std::string_view wanted) {
            return std::find_if(parameters.begin(), parameters.end(),
                                [&](const Parameter& p) { return p.name == wanted; });
        };
        auto found = with_name(key);
        if (const auto present = present_name("filter parameter", key);
            found == parameters.end() && present) {
            found = with_name(*present);
            if (found != parameters.end()) choice.hints.push_back(old_name_hint(key, *present));
        }
        if (found == parameters.end()) {
            std::vector<std::string_view> names;
            for (const Parameter& p : parameters) names.push_back(p.name);
            return wrong("filter '" + std::string(filter.name) + "' has no parameter '" +
                         std::string(key.substr(0, 64)) +
                         "': " + (names.empty() ? "it has none" : "it has " + list(names)));
        }
        if (equals == std::string_view::npos) {
            return wrong("parameter '" + std::string(key) + "' has no value: write " + std::string(key) +
                         "=VALUE");
        }
        const auto value = value_of(filter, *found, item.substr(equals + 1));
        if (!value) return tl::unexpected(value.error());
        choice.values[static_cast<std::size_t>(found - parameters.begin())] = *value;
    }
    return choice;
}

frame::ChannelSet missing_channels(const Choice& choice, frame::ChannelSet there) {
    const bool is_none = choice.entry->description.name == "none";
    if (is_none && there.contains(frame::Channel::Color)) there.insert(frame::Channel::Radiance);
    return choice.channels() - there;
}

frame::ChannelSet wanted_channels(const Choice& choice, frame::ChannelSet there) {
    frame::ChannelSet wanted = missing_channels(choice, there);
    if (choice.entry->description.reads_variances)
        wanted = wanted | (frame::ChannelSet{frame::Channel::BlockVariance} - there);
    return wanted;
}

std::string why_unavailable(const FilterEntry& entry) {
    return entry.why_unavailable == nullptr ? std::string() : entry.why_unavailable();
}

std::string why_not_reproducible(const FilterEntry& entry) {
    if (entry.description.reproducible) return {};
    return "filter '" + std::string(entry.description.name) +
           "' does not give the same bits on every machine: choose another filter for a reproducible frame";
}

std::string why_no_error_estimate(const Choice& choice) {
    using enum frame::Channel;
    constexpr frame::ChannelSet Readable{Radiance,    BlockVariance, Albedo,    Normal,        Depth,
                                         ObjectIndex, Alpha,         Headlight, ShadingFeature};
    const std::string name = "filter '" + std::string(choice.entry->description.name) + "'";
    if (choice.entry->description.temporal) return name + " has a history of earlier pictures";
    std::string why;
    (choice.channels() - Readable).for_each([&](const frame::ChannelInfo& entry) {
        why = name + " reads '" + std::string(entry.name) +
              "', which the film does not have of each half of its samples";
        return false;
    });
    return why;
}

std::string to_text(const Choice& choice) {
    const Description& filter = choice.entry->description;
    std::string text;
    for (std::size_t i = 0; i < filter.parameters.size(); ++i) {
        const Parameter& parameter = filter.parameters[i];
        if (choice.values[i] == parameter.default_value) continue;
        text += (text.empty() ? ":" : ",") + std::string(parameter.name) + "=";
        text += parameter.choices.empty()
                    ? number(choice.values[i])
                    : std::string(parameter.choices[static_cast<std::size_t>(choice.values[i])]);
    }
    return std::string(filter.name) + text;
}

}  // namespace tessera::filter
