#include "client/edit/tokenizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/edit/script_error.h"

namespace tessera::edit {
namespace {

std::vector<std::string> texts(std::string_view line) {
    std::vector<std::string> result;
    for (const Word& word : split(line)) result.push_back(word.text());
    return result;
}

std::size_t error_column(std::string_view line) {
    try {
        split(line);
    } catch (const ScriptError& error) {
        return error.column();
    }
    return 0;
}

TEST(Tokenizer, SplitsAtBlanks) {
    EXPECT_THAT(texts("  set a.b\t0.8  1 \r"), testing::ElementsAre("set", "a.b", "0.8", "1"));
    EXPECT_THAT(texts(""), testing::IsEmpty());
}

TEST(Tokenizer, QuotesHoldBlanksAndJoin) {
    EXPECT_THAT(texts(R"(show materials/"my red" "")"), testing::ElementsAre("show", "materials/my red", ""));
}

TEST(Tokenizer, EscapesWorkInsideAndOutsideOfQuotes) {
    EXPECT_THAT(texts(R"(a\ b "c\"d\\" \x41\n "\t" \q)"),
                testing::ElementsAre("a b", "c\"d\\", "A\n", "\t", "q"));
}

TEST(Tokenizer, CommentsBeginAtTheStartOfAWord) {
    EXPECT_THAT(texts("set a#b # c d"), testing::ElementsAre("set", "a#b"));
    EXPECT_THAT(texts("# all"), testing::IsEmpty());
    EXPECT_THAT(texts("\"# no\""), testing::ElementsAre("# no"));
}

TEST(Tokenizer, ColumnsCountCharacters) {
    const std::vector<Word> words = split("s\xc3\xa4t  \"\xe2\x82\xac\"/x,y");
    ASSERT_EQ(words.size(), 2u);
    EXPECT_EQ(words[1].column(), 6u);
    EXPECT_EQ(words[1].split(',')[1].column(), 12u);
}

TEST(Tokenizer, QuotedPunctuationIsLiteral) {
    const std::vector<Word> words = split(R"(a"."b.c \@1@2)");
    EXPECT_EQ(words[0].find('.'), 3u);
    EXPECT_EQ(words[1].rfind('@'), 2u);
    EXPECT_EQ(words[1].find('@'), 2u);
    EXPECT_FALSE(split("\"in\"")[0].is("in"));
    EXPECT_TRUE(split("in")[0].is("in"));
}

TEST(Tokenizer, ErrorsNameTheColumn) {
    EXPECT_EQ(error_column("show \"open"), 6u);
    EXPECT_EQ(error_column(std::string_view("a\0b", 3)), 2u);
    EXPECT_EQ(error_column("fine"), 0u);
}

TEST(Tokenizer, QuotedTextRoundTrips) {
    for (const std::string text : {"plain", "my red", "a\"b\\c", "", "# x", "a@1", "line\nend\t\x01\x7f",
                                   "\xff\xfe", "in", "a=b,c*?", "Cube.001", "\xc3\xa4"}) {
        EXPECT_THAT(texts(edit::in_quotes(text)), testing::ElementsAre(text)) << edit::in_quotes(text);
    }
    EXPECT_EQ(in_quotes("Cube.001"), "Cube.001");
}

TEST(Tokenizer, PatternsMatch) {
    EXPECT_TRUE(matches("*", ""));
    EXPECT_TRUE(matches("w*l", "wheel"));
    EXPECT_TRUE(matches("w?eel", "wheel"));
    EXPECT_TRUE(matches("*el*", "wheel"));
    EXPECT_FALSE(matches("w?l", "wheel"));
    EXPECT_FALSE(matches("", "a"));
    EXPECT_FALSE(matches("a*b", "a"));
    // Would take exponential time with naive backtracking.
    EXPECT_FALSE(matches("a*a*a*a*a*a*a*a*a*a*b", std::string(2000, 'a')));
}

}  // namespace
}  // namespace tessera::edit
