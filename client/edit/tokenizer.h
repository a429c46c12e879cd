#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::edit {

// One word of a line, without its quotes and escapes. Quoted or escaped characters do not count as punctuation.
class Word {
  public:
    Word() = default;
    explicit Word(std::size_t column) : column_(column) {}

    const std::string& text() const { return text_; }
    std::size_t column() const { return column_; }  // from 1, in characters
    bool empty() const { return text_.empty(); }
    bool is(std::string_view keyword) const;  // not quoted
    bool is_quoted() const { return is_quoted_; }

    static constexpr std::size_t None = std::string::npos;
    std::size_t find(char punctuation, std::size_t from = 0) const;  // not quoted
    std::size_t rfind(char punctuation) const;
    Word part(std::size_t begin, std::size_t end = None) const;
    std::vector<Word> split(char punctuation) const;

    void add(char byte, bool is_literal, std::size_t column);
    void mark_quoted() { is_quoted_ = true; }  // so that "" counts as a word

  private:
    std::string text_;
    std::vector<bool> literal_;         // per byte
    std::vector<std::size_t> columns_;  // per byte
    std::size_t column_ = 1;
    bool is_quoted_ = false;
};

// The words of a line: separated by blanks, quoted by "", escaped by \ (\n, \t, \xHH, else the character
// itself). A word that begins with # starts a comment.
struct SplitLine {
    std::vector<Word> words;
    std::size_t open_quote = 0;   // its column if the line ends inside a quote
    bool ends_with_word = false;  // no blank after the last one
};
SplitLine split_lenient(std::string_view line);
std::vector<Word> split(std::string_view line);  // throws ScriptError

// Quotes and escapes the text as one word, if necessary.
std::string in_quotes(std::string_view text);

// True if `text` matches the pattern (* any characters, ? one character).
bool matches(std::string_view pattern, std::string_view text);

}  // namespace tessera::edit
