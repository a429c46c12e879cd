#include "client/edit/completion.h"
#include "mediator/base/random.h"
#include "tests/edit/fake_target.h"

// Random bytes and damaged scripts result in an error or a valid scene; failures change nothing.
namespace tessera::edit {
namespace {

const std::vector<std::string>& pieces() {
    static const std::vector<std::string> Pieces{"set",
                                                 "move",
                                                 "rotate",
                                                 "scale",
                                                 "create",
                                                 "attach",
                                                 "detach",
                                                 "remove",
                                                 "-r",
                                                 "list",
                                                 "show",
                                                 "find",
                                                 "tree",
                                                 "undo",
                                                 "redo",
                                                 "log",
                                                 "lock",
                                                 "unlock",
                                                 "members",
                                                 "begin",
                                                 "commit",
                                                 "rollback",
                                                 "help",
                                                 "quit",
                                                 "in",
                                                 "from",
                                                 "lights/bulb",
                                                 "transforms/left",
                                                 "transforms/wheel",
                                                 "transforms/@15",
                                                 "materials/\"my \\\"red\\\"\"",
                                                 "root",
                                                 "textures/wood",
                                                 "none",
                                                 "identity",
                                                 "lights/bulb.intensity",
                                                 "transforms/left.children",
                                                 "root.children",
                                                 "transforms/wheel.matrix",
                                                 "geometries/square.material",
                                                 "light",
                                                 "material",
                                                 "transform",
                                                 "x",
                                                 "new",
                                                 "kind=spot",
                                                 "intensity=1,2,3",
                                                 "0",
                                                 "1",
                                                 "-1.5",
                                                 "1e30",
                                                 "nan",
                                                 "0.8,0.1",
                                                 "\"",
                                                 "\\",
                                                 "#",
                                                 "*",
                                                 "/",
                                                 "@",
                                                 ".",
                                                 "=",
                                                 ",",
                                                 "\n",
                                                 "\n",
                                                 "\n",
                                                 "\n"};
    return Pieces;
}

void survives(const std::string& text) {
    SCOPED_TRACE(text);
    FakeTarget target;  // checks that what it takes is valid
    const Hash128 before = target.scene().state_hash();
    if (!target.script(text)) {
        EXPECT_THAT(target.error(), testing::StartsWith("test.txt:"));
        EXPECT_EQ(target.scene().state_hash(), before);
    }
    complete(text, text.size() / 2, target.scene());
}

TEST(EditFuzz, RandomBytes) {
    CounterRandom random(1);
    for (int round = 0; round < 300; ++round) {
        std::string text;
        for (std::uint64_t left = random.below(80); left > 0; --left)
            text += static_cast<char>(random.below(256));
        survives(text);
    }
}

TEST(EditFuzz, RandomWords) {
    const std::vector<std::string> commands{"set",    "move",   "rotate", "scale", "create",
                                            "attach", "detach", "remove", "list",  "show",
                                            "find",   "tree",   "lock",   "commit"};
    CounterRandom random(2);
    int accepted = 0;
    for (int round = 0; round < 20000; ++round) {
        std::string text;
        for (std::uint64_t lines = 1 + random.below(3); lines > 0; --lines) {
            text += commands[random.below(commands.size())] + " ";
            for (std::uint64_t left = 1 + random.below(4); left > 0; --left) {
                text += pieces()[random.below(pieces().size())];
                text += random.below(8) == 0 ? "" : " ";
            }
            text += "\n";
        }
        survives(text);
        FakeTarget target;
        accepted += target.script(text) && !target.labels.empty() ? 1 : 0;
    }
    EXPECT_GE(accepted, 15) << "words that never edit test nothing behind the parser";
}

TEST(EditFuzz, DamagedScripts) {
    const std::string whole =
        "# tour\nset lights/bulb.intensity 1 2 3\ncreate transform t in transforms/left\n"
        "create light l kind=spot intensity=1,2,3 in transforms/t\nattach transforms/wheel in transforms/t\n"
        "set materials/\"my \\\"red\\\"\".base_color_texture textures/data offset=1,2\ncommit\n"
        "rotate transforms/wheel 1 0 0 45\nremove geometries/square -r\nset root.children transforms/t\nshow "
        "root\n"
        "commit\nset transforms/wheel.matrix 1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1\nlock root\ntree\n";
    {
        FakeTarget target;
        ASSERT_TRUE(target.script(whole)) << target.error();
        EXPECT_EQ(target.labels.size(), 3u);
    }
    CounterRandom random(3);
    for (int round = 0; round < 3000; ++round) {
        std::string text = whole;
        for (std::uint64_t left = 1 + random.below(3); left > 0; --left) {
            const std::size_t at = random.below(text.size());
            switch (random.below(4)) {
                case 0:
                    text[at] = static_cast<char>(random.below(256));
                    break;
                case 1:
                    text.erase(at, 1 + random.below(8));
                    break;
                case 2:
                    text.insert(at, pieces()[random.below(pieces().size())]);
                    break;
                default:
                    std::swap(text[at], text[random.below(text.size())]);
            }
            if (text.empty()) break;
        }
        survives(text);
    }
}

}  // namespace
}  // namespace tessera::edit
