#include "client/edit/tokenizer.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "client/edit/script_error.h"

namespace tessera::edit {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

bool is_plain(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x80 ||
           (byte > ' ' && byte < 0x7f && std::string_view("\"\\#@=,*?").find(c) == std::string_view::npos);
}

class Splitter {
  public:
    explicit Splitter(std::string_view line) : line_(line) {}

    SplitLine run() {
        while (at_ < line_.size()) {
            if (is_blank(line_[at_])) {
                advance();
            } else if (line_[at_] == '#') {
                return std::move(result_);
            } else {
                word();
            }
        }
        return std::move(result_);
    }

  private:
    void word() {
        Word word(column_);
        bool inside = false;
        std::size_t quote = 0;
        while (at_ < line_.size() && (inside || !is_blank(line_[at_]))) {
            const char c = line_[at_];
            const std::size_t column = column_;
            if (c == '"') {
                inside = !inside;
                quote = column;
                word.mark_quoted();
                advance();
            } else if (c == '\\' && at_ + 1 < line_.size()) {
                word.add(escaped(), true, column);
            } else {
                word.add(c, inside, column);
                advance();
            }
        }
        if (inside) result_.open_quote = quote;
        result_.ends_with_word = at_ >= line_.size();
        result_.words.push_back(std::move(word));
    }

    char escaped() {
        advance();
        const char c = line_[at_];
        advance();
        if (c == 'n') return '\n';
        if (c == 't') return '\t';
        if (c == 'x' && at_ + 1 < line_.size()) {
            const int high = hex_digit(line_[at_]), low = hex_digit(line_[at_ + 1]);
            if (high >= 0 && low >= 0) {
                advance();
                advance();
                return static_cast<char>(high * 16 + low);
            }
        }
        return c;
    }

    void advance() {
        ++at_;
        const bool is_inside_character =
            at_ < line_.size() && (static_cast<unsigned char>(line_[at_]) & 0xc0) == 0x80;
        if (!is_inside_character) ++column_;
    }

    std::string_view line_;
    std::size_t at_ = 0, column_ = 1;
    SplitLine result_;
};

}  // namespace

bool Word::is(std::string_view keyword) const {
    return !is_quoted_ && text_ == keyword;
}

std::size_t Word::find(char punctuation, std::size_t from) const {
    for (std::size_t i = from; i < text_.size(); ++i) {
        if (text_[i] == punctuation && !literal_[i]) return i;
    }
    return None;
}

std::size_t Word::rfind(char punctuation) const {
    for (std::size_t i = text_.size(); i-- > 0;) {
        if (text_[i] == punctuation && !literal_[i]) return i;
    }
    return None;
}

Word Word::part(std::size_t begin, std::size_t end) const {
    end = std::min(end, text_.size());
    Word word(begin < text_.size() ? columns_[begin] : column_ + begin);
    word.is_quoted_ = is_quoted_ && begin == 0 && end == text_.size();
    for (std::size_t i = begin; i < end; ++i) {
        word.add(text_[i], literal_[i], columns_[i]);
        word.is_quoted_ |= literal_[i];
    }
    return word;
}

std::vector<Word> Word::split(char punctuation) const {
    std::vector<Word> parts;
    std::size_t begin = 0;
    for (std::size_t at = find(punctuation); at != None; at = find(punctuation, begin)) {
        parts.push_back(part(begin, at));
        begin = at + 1;
    }
    parts.push_back(part(begin));
    return parts;
}

void Word::add(char byte, bool is_literal, std::size_t column) {
    text_ += byte;
    literal_.push_back(is_literal);
    columns_.push_back(column);
    is_quoted_ |= is_literal;
}

SplitLine split_lenient(std::string_view line) {
    return Splitter(line).run();
}

std::vector<Word> split(std::string_view line) {
    std::size_t column = 1;
    for (const char c : line) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < ' ' && !is_blank(c)) {
            throw ScriptError(column, "the line holds a control character: write text, \\n or \\xHH");
        }
        column += (byte & 0xc0) == 0x80 ? 0 : 1;
    }
    SplitLine split = split_lenient(line);
    if (split.open_quote != 0) throw ScriptError(split.open_quote, "the quote is not closed: add a \"");
    return std::move(split.words);
}

std::string in_quotes(std::string_view text) {
    if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return std::string(text);
    constexpr std::string_view Digits = "0123456789abcdef";
    std::string result = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            result += {'\\', c};
        } else if (c == '\n') {
            result += "\\n";
        } else if (c == '\t') {
            result += "\\t";
        } else if (byte < ' ' || byte == 0x7f) {
            result += {'\\', 'x', Digits[byte / 16], Digits[byte % 16]};
        } else {
            result += c;
        }
    }
    return result + "\"";
}

bool matches(std::string_view pattern, std::string_view text) {
    std::size_t p = 0, t = 0, star = std::string_view::npos, resume = 0;
    while (t < text.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            resume = t;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
            ++p;
            ++t;
        } else if (star != std::string_view::npos) {
            p = star + 1;
            t = ++resume;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

}  // namespace tessera::edit
