#include "client/edit/value_reader.h"

#include <charconv>
#include <cmath>

#include "client/edit/script_error.h"
#include "mediator/base/nearest.h"

namespace tessera::edit {

double read_number(const Word& word) {
    double value = 0.0;
    const std::string& text = word.text();
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec == std::errc::result_out_of_range || (parsed.ec == std::errc() && !std::isfinite(value))) {
        throw ScriptError(word.column(), "'" + text + "' is out of range: numbers must be finite");
    }
    if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) {
        throw ScriptError(word.column(), "'" + text + "' is not a valid number: write it as 0.8 or -1e3");
    }
    return value;
}

ValueReader::ValueReader(const std::vector<Word>& words, std::size_t end_column, std::string form,
                         const ReadPath& read_path)
    : whole_(words), end_column_(end_column), form_(std::move(form)), read_path_(read_path) {
    for (const Word& word : words) {
        for (Word& piece : word.split(',')) pieces_.push_back(std::move(piece));
    }
}

const Word& ValueReader::next() {
    if (at_ == pieces_.size()) throw ScriptError(end_column_, "the value is incomplete: write " + form_);
    return pieces_[at_++];
}

void ValueReader::wrong(const Word& word) const {
    throw ScriptError(word.column(), "'" + word.text() + "' is not expected here: write " + form_);
}

void ValueReader::expect_end() const {
    if (at_ < pieces_.size()) wrong(pieces_[at_]);
}

float ValueReader::number() {
    const Word& word = next();
    const auto value = static_cast<float>(read_number(word));
    if (!std::isfinite(value)) {
        throw ScriptError(word.column(), "'" + word.text() + "' exceeds the range of the field (3.4e38)");
    }
    return value;
}

std::size_t ValueReader::choice(const std::vector<std::string>& names) {
    const Word& word = next();
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (word.text() == names[i]) return i;
    }
    const auto best = nearest(word.text(), names);
    throw ScriptError(word.column(), "'" + word.text() + "' is not one of " + form_ +
                                         (best ? "; did you mean '" + *best + "'?" : ""));
}

template <class V>
void ValueReader::numbers(V& value, glm::length_t count) {
    using N = typename V::value_type;
    V result = value;
    for (glm::length_t i = 0; i < count; ++i) {
        if constexpr (std::is_same_v<N, float>) {
            result[i] = number();
        } else {
            result[i] = read_number(next());
        }
    }
    value = result;
}

void ValueReader::read(std::string& value) {
    if (whole_.empty()) next();
    if (whole_.size() > 1) {
        throw ScriptError(whole_[1].column(), "the text has several words: quote it, \"like this\"");
    }
    value = whole_[0].text();
    at_ = pieces_.size();
}

void ValueReader::read(bool& value) {
    static const std::vector<std::string> Words{"false", "true", "no", "yes", "off", "on", "0", "1"};
    value = choice(Words) % 2 == 1;
}

void ValueReader::read(float& value) {
    value = number();
}

void ValueReader::read(double& value) {
    value = read_number(next());
}

template <class I>
void ValueReader::whole_number(I& value) {
    const Word& word = next();
    const std::string& text = word.text();
    I number{};
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) wrong(word);
    value = number;
}

void ValueReader::read(std::uint32_t& value) {
    whole_number(value);
}

void ValueReader::read(std::int32_t& value) {
    whole_number(value);
}

void ValueReader::read(glm::vec2& value) {
    if (left() == 1) {
        value = glm::vec2(number());
    } else {
        numbers(value, 2);
    }
}

void ValueReader::read(glm::vec3& value) {
    if (left() == 1) {
        value = glm::vec3(number());
    } else {
        numbers(value, 3);
    }
}

void ValueReader::read(glm::vec4& value) {
    numbers(value, left() == 3 ? 3 : 4);
}

void ValueReader::read(glm::dvec3& value) {
    numbers(value, 3);
}

void ValueReader::read(glm::dmat4& value) {
    if (left() == 1) {
        if (const Word& word = next(); !word.is("identity")) wrong(word);
        value = glm::dmat4(1.0);
        return;
    }
    glm::dmat4 result;
    for (glm::length_t column = 0; column < 4; ++column) numbers(result[column], 4);
    value = result;
}

void ValueReader::read(std::vector<glm::dmat4>& value) {
    std::vector<glm::dmat4> result;
    if (left() == 1 && pieces_[at_].is("none")) {
        ++at_;
    } else {
        do {
            glm::dmat4& step = result.emplace_back(1.0);
            if (left() > 0 && pieces_[at_].is("identity")) {
                ++at_;
                continue;
            }
            for (glm::length_t column = 0; column < 4; ++column) numbers(step[column], 4);
        } while (left() > 0);
    }
    value = std::move(result);
}

void ValueReader::read(ObjectId& value) {
    const Word& word = next();
    value = word.is("none") ? ObjectId{} : read_path_(word);
}

void ValueReader::read(std::vector<ObjectId>& value) {
    std::vector<ObjectId> result;
    if (left() == 1 && pieces_[at_].is("none")) {
        ++at_;
    } else {
        do result.push_back(read_path_(next()));
        while (left() > 0);
    }
    value = std::move(result);
}

void ValueReader::read(scene::TextureSlot& value) {
    scene::TextureSlot result = value;
    if (left() == 0) next();
    if (pieces_[at_].find('=') == Word::None) read(result.texture);
    while (left() > 0) {
        const Word word = pieces_[at_];
        const std::size_t equals = word.find('=');
        if (equals == Word::None) wrong(word);
        const Word key = word.part(0, equals);
        pieces_[at_] = word.part(equals + 1);
        if (key.is("offset")) {
            numbers(result.offset, 2);
        } else if (key.is("scale")) {
            numbers(result.scale, 2);
        } else if (key.is("rotation")) {
            result.rotation = number();
        } else if (key.is("set")) {
            read(result.set);
        } else {
            wrong(word);
        }
    }
    value = result;
}

void ValueReader::reject_bytes() const {
    throw ScriptError(whole_.empty() ? end_column_ : whole_[0].column(),
                      "arrays and texels cannot be typed: import them with 'load FILE'");
}

void ValueReader::read(scene::BlobRef&) {
    reject_bytes();
}

void ValueReader::read(std::vector<scene::BlobRef>&) {
    reject_bytes();
}

}  // namespace tessera::edit
