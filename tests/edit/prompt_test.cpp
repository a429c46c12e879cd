#include "client/edit/prompt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <mutex>
#include <thread>

#include "tests/edit/fake_target.h"
#include "tests/import/scene_file.h"

namespace tessera::edit {
namespace {

// A terminal with a simulated user, who types once the prompt is shown: before that, the
// prompt does not control the terminal.
class Terminal {
  public:
    Terminal() {
        int program = -1;
        EXPECT_EQ(openpty(&keyboard_, &program, nullptr, nullptr, nullptr), 0);
        in_ = fdopen(program, "r");
        out_ = fdopen(dup(program), "w");
        person_ = std::thread([this] { sit(); });
    }
    ~Terminal() { finish(); }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    // Waits until this prompt is shown for the first time.
    void will_type(const std::string& keys, const std::string& prompt) {
        const std::lock_guard lock(mutex_);
        keys_ = keys;
        prompt_ = prompt;
    }
    // All output. No prompt is shown afterwards.
    std::string finish() {
        if (in_ == nullptr) return seen_;
        fclose(in_);
        fclose(out_);
        in_ = out_ = nullptr;
        person_.join();
        close(keyboard_);
        return seen_;
    }
    std::FILE* in() const { return in_; }
    std::FILE* out() const { return out_; }

  private:
    void sit() {
        char text[256];
        for (ssize_t count = 0; (count = ::read(keyboard_, text, sizeof text)) > 0;) {
            const std::lock_guard lock(mutex_);
            seen_.append(text, static_cast<std::size_t>(count));
            if (keys_.empty() || seen_.find(prompt_) == std::string::npos) continue;
            // The prompt is shown a moment before single keys are read.
            for (termios mode{}; tcgetattr(keyboard_, &mode) == 0 && (mode.c_lflag & ICANON) != 0;) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            EXPECT_EQ(::write(keyboard_, keys_.data(), keys_.size()), static_cast<ssize_t>(keys_.size()));
            keys_.clear();
        }
    }

    int keyboard_ = -1;
    std::FILE *in_ = nullptr, *out_ = nullptr;
    std::mutex mutex_;  // protects what follows
    std::string keys_, prompt_, seen_;
    std::thread person_;
};

class PromptTest : public testing::Test {
  protected:
    void SetUp() override { ASSERT_EQ(setenv("TERM", "vt100", 1), 0); }
    // The lines that the prompt returns for these keys, until the end of input.
    std::vector<std::string> lines(const std::vector<std::string>& keys) {
        Terminal terminal;
        std::vector<std::string> result;
        {
            Prompt prompt(terminal.in(), terminal.out(), history_,
                          [&](std::string_view text, std::size_t cursor) {
                              return complete(text, cursor, target_.scene());
                          });
            for (const std::string& key : keys) {
                const std::string ask = "prompt " + std::to_string(result.size()) + "> ";
                terminal.will_type(key, ask);
                const auto line = prompt.read(ask);
                result.push_back(line.value_or("(end)"));
            }
        }
        shown_ = terminal.finish();
        return result;
    }
    FakeTarget target_;
    import::TestFolder folder_;
    std::filesystem::path history_ = folder_.path() / "below" / "history";
    std::string shown_;
};

TEST_F(PromptTest, ReadsLinesUntilControlD) {
    EXPECT_THAT(lines({"list\n", "\n", "show root\n", "\x04"}),
                testing::ElementsAre("list", "", "show root", "(end)"));
    EXPECT_THAT(shown_, testing::HasSubstr("prompt 3> "));
}

TEST_F(PromptTest, ControlCClearsTheLine) {
    EXPECT_THAT(lines({"remove transforms/left\x03", "quit\n", "abc\x02\x02\x03", "x\n"}),
                testing::ElementsAre("", "quit", "", "x"));
}

TEST_F(PromptTest, TabCompletes) {
    EXPECT_THAT(lines({"sho\tlights/b\t\n", "set lights/sun.ki\tspo\t\n", "show lights/s\tu\t\n"}),
                testing::ElementsAre("show lights/bulb ", "set lights/sun.kind spot ", "show lights/sun "));
    EXPECT_THAT(shown_, testing::HasSubstr("lights/spot"));
}

TEST_F(PromptTest, RemembersLinesInAFile) {
    EXPECT_THAT(lines({"list lights\n", "  \n", "tree\n"}), testing::SizeIs(3));
    EXPECT_THAT(lines({"\x10\n", "\x10\x10\n"}), testing::ElementsAre("tree", "list lights"))
        << "Ctrl-P: the line before";
    std::ifstream file(history_);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_THAT(text, testing::HasSubstr("tree\n"));
    namespace fs = std::filesystem;
    EXPECT_EQ(fs::status(history_).permissions() & (fs::perms::group_all | fs::perms::others_all),
              fs::perms::none);
}

TEST_F(PromptTest, UnwritableHistoryIsIgnored) {
    history_ = "/proc/nowhere/history";
    EXPECT_THAT(lines({"list\n", "\x04"}), testing::ElementsAre("list", "(end)"));
}

TEST_F(PromptTest, TheHistoryIsInTheStateFolder) {
    ASSERT_EQ(setenv("XDG_STATE_HOME", "/a/state", 1), 0);
    EXPECT_EQ(default_history_file(), "/a/state/tessera/edit_history");
    ASSERT_EQ(setenv("XDG_STATE_HOME", "relative", 1), 0);
    ASSERT_EQ(setenv("HOME", "/home/anna", 1), 0);
    EXPECT_EQ(default_history_file(), "/home/anna/.local/state/tessera/edit_history");
}

}  // namespace
}  // namespace tessera::edit
