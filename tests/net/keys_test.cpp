#include "mediator/net/keys.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <functional>

#include "mediator/net/key_file.h"
#include "mediator/net/secret_file.h"
#include "tests/net/net_support.h"

namespace tessera::net {

namespace {

class KeyFiles : public testing::Test {
  protected:
    KeyFiles() : keys_(folder_ / "keys") { keys_.create(); }

    static mode_t mode(const std::filesystem::path& path) {
        struct stat status {};
        EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
        return status.st_mode & 0777;
    }

    TemporaryFolder folder_;
    KeyDirectory keys_;
};

// The error of a call: its text, with a word for its code in front.
template <class Call>
std::pair<ErrorCode, std::string> error_of(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
    ADD_FAILURE() << "nothing was thrown";
    return {ErrorCode::Internal, ""};
}

TEST_F(KeyFiles, CreateMakesAMasterAndOnePairPerRole) {
    const std::vector<AllowedKey> allowed = keys_.allowed();
    ASSERT_EQ(allowed.size(), 4u);
    for (const AllowedKey& key : allowed) {
        EXPECT_EQ(key.name, name(key.role));
        const ClientKeys own = keys_.client(key.name);
        EXPECT_EQ(own.own.public_key, key.public_key);
        EXPECT_EQ(own.server_public_key, keys_.master().public_key);
        EXPECT_EQ(mode(folder_ / "keys" / (key.name + ".secret")), 0600u);
    }
    EXPECT_EQ(mode(folder_ / "keys" / "master.secret"), 0600u);
    EXPECT_EQ(mode(folder_ / "keys"), 0700u);
}

TEST_F(KeyFiles, AnAllowListThatOthersMayChangeIsRefusedWithTheRemedy) {
    const std::filesystem::path list = folder_ / "keys" / "allowed.keys";
    ASSERT_EQ(::chmod(list.c_str(), 0622), 0);
    const auto file = error_of([&] { (void)keys_.allowed(); });
    EXPECT_EQ(file.first, ErrorCode::Refused);
    EXPECT_NE(file.second.find("chmod go-w"), std::string::npos) << file.second;
    ASSERT_EQ(::chmod(list.c_str(), 0644), 0);
    EXPECT_EQ(keys_.allowed().size(), 4u);
    ASSERT_EQ(::chmod(list.parent_path().c_str(), 0777), 0);
    EXPECT_EQ(error_of([&] { (void)keys_.allowed(); }).first, ErrorCode::Refused);
}

TEST_F(KeyFiles, CreateNeverReplacesAMaster) {
    const KeyPair before = keys_.master();
    EXPECT_EQ(error_of([&] { keys_.create(); }).first, ErrorCode::Refused);
    EXPECT_EQ(keys_.master().secret_key, before.secret_key);
}

TEST_F(KeyFiles, CreateLeavesTheModeOfAFolderThatWasThere) {
    const auto place = folder_ / "shared";
    std::filesystem::create_directory(place);
    ASSERT_EQ(chmod(place.c_str(), 0755), 0);
    KeyDirectory(place).create();
    EXPECT_EQ(mode(place), 0755u);
}

TEST_F(KeyFiles, SecretsThatOthersMayReadAreRefusedWithTheRemedy) {
    keys_.add("far", Role::Node, folder_ / "far.key");
    struct Case {
        std::filesystem::path file;
        std::function<void()> read;
    };
    const std::vector<Case> cases{
        {folder_ / "keys/master.secret", [&] { keys_.master(); }},
        {folder_ / "keys/node.secret", [&] { keys_.client("node"); }},
        {folder_ / "far.key", [&] { KeyDirectory(folder_ / "far.key").client(""); }}};
    for (const Case& one : cases) {
        for (const mode_t open : {0640u, 0604u, 0620u, 0601u, 0666u}) {
            ASSERT_EQ(chmod(one.file.c_str(), open), 0);
            const auto [code, text] = error_of(one.read);
            EXPECT_EQ(code, ErrorCode::Refused);
            EXPECT_NE(text.find("chmod 600 '" + one.file.string() + "'"), std::string::npos) << text;
        }
        ASSERT_EQ(chmod(one.file.c_str(), 0400), 0);
        EXPECT_NO_THROW(one.read());
    }
}

TEST_F(KeyFiles, AnExportHoldsOnePairAndTheMastersPublicKeyOnly) {
    keys_.add("render-2", Role::Node, folder_ / "render-2.key");
    EXPECT_EQ(mode(folder_ / "render-2.key"), 0600u);
    const ClientKeys far = KeyDirectory(folder_ / "render-2.key").client("any name");
    EXPECT_EQ(far.server_public_key, keys_.master().public_key);
    EXPECT_EQ(far.own.public_key, keys_.allowed().back().public_key);
    EXPECT_EQ(keys_.allowed().back().role, Role::Node);
    const std::string text = read_text(folder_ / "render-2.key");
    EXPECT_EQ(text.find(keys_.master().secret_key), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "keys/render-2.secret"));
    EXPECT_EQ(error_of([&] { KeyDirectory(folder_ / "render-2.key").master(); }).first, ErrorCode::NotFound);
}

TEST_F(KeyFiles, AddRefusesExistingNamesAndFiles) {
    keys_.add("a", Role::Viewer, folder_ / "a.key");
    const auto before = keys_.allowed().size();
    const auto add = [&](const std::string& name, Role role, const std::string& file) {
        return error_of([&] { keys_.add(name, role, folder_ / file); }).first;
    };
    EXPECT_EQ(add("a", Role::Viewer, "b.key"), ErrorCode::Refused) << "a name twice";
    EXPECT_EQ(add("b", Role::Viewer, "a.key"), ErrorCode::Refused) << "a file that is there";
    EXPECT_EQ(add("b", Role::None, "b.key"), ErrorCode::InvalidInput);
    EXPECT_EQ(add("b", Role::Viewer, "no/such/folder/b.key"), ErrorCode::Io);
    for (const char* bad : {"", "master", "../b", "a b", "b\nroot", "b:c", "b/c", "#b"}) {
        EXPECT_EQ(add(bad, Role::Viewer, "b.key"), ErrorCode::InvalidInput) << bad;
    }
    EXPECT_EQ(add(std::string(65, 'x'), Role::Viewer, "b.key"), ErrorCode::InvalidInput);
    EXPECT_EQ(keys_.allowed().size(), before);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "b.key"));
}

TEST_F(KeyFiles, RevokeTakesTheKeyOffTheListAndItsLocalPairAway) {
    keys_.revoke("node");
    for (const AllowedKey& key : keys_.allowed()) EXPECT_NE(key.name, "node");
    EXPECT_EQ(error_of([&] { keys_.client("node"); }).first, ErrorCode::NotFound);
    EXPECT_EQ(error_of([&] { keys_.revoke("node"); }).first, ErrorCode::NotFound);
    EXPECT_EQ(error_of([&] { keys_.revoke("master"); }).first, ErrorCode::NotFound);
    EXPECT_NO_THROW(keys_.master());
}

TEST_F(KeyFiles, NamesCannotEscapeTheFolder) {
    for (const char* name : {"../keys/node", "/etc/passwd", "..", ""}) {
        EXPECT_EQ(error_of([&] { keys_.client(name); }).first, ErrorCode::InvalidInput) << name;
    }
}

TEST_F(KeyFiles, MismatchedPairsAreReported) {
    std::filesystem::copy_file(folder_ / "keys/viewer.public", folder_ / "keys/node.public",
                               std::filesystem::copy_options::overwrite_existing);
    const auto [code, text] = error_of([&] { keys_.client("node"); });
    EXPECT_EQ(code, ErrorCode::InvalidInput);
    EXPECT_NE(text.find("node.secret"), std::string::npos);
}

TEST_F(KeyFiles, MissingFoldersNameTheCommandThatCreatesThem) {
    const auto [code, text] = error_of([&] { KeyDirectory(folder_ / "nowhere").client("node"); });
    EXPECT_EQ(code, ErrorCode::NotFound);
    EXPECT_NE(text.find("tessera keys"), std::string::npos);
    EXPECT_EQ(error_of([&] { KeyDirectory(folder_ / "nowhere").allowed(); }).first, ErrorCode::NotFound);
}

TEST_F(KeyFiles, ErrorsInAllowListsNameTheLine) {
    const std::string a = make_key_pair().public_key, b = make_key_pair().public_key;
    const auto parse = [&](const std::string& text) { return parse_allowed("list", text); };
    EXPECT_EQ(parse("# comment\n\n  \na viewer " + a + "\nb node " + b + " \n").size(), 2u);
    for (const std::string& bad :
         {std::string("b viewer"), "b viewer " + a, "a editor " + b, "b root " + b, "b viewer " + b + " more",
          "b viewer " + b.substr(1), "b viewer " + b + "x", std::string("../b viewer ") + b,
          "b viewer " + std::string(40, '~'), std::string("b\0c viewer ", 11) + b, "b none " + b}) {
        const auto [code, text] = error_of([&] { parse("a viewer " + a + "\n" + bad + "\n"); });
        EXPECT_EQ(code, ErrorCode::InvalidInput) << bad;
        EXPECT_NE(text.find("list"), std::string::npos) << text;
    }
}

TEST_F(KeyFiles, EveryTruncationOfAnExportIsRefusedOrComplete) {
    const KeyExport exported{
        .name = "x", .role = Role::Editor, .keys = {make_key_pair(), keys_.master().public_key}};
    const std::string text = export_text(exported);
    for (std::size_t length = 0; length < text.size(); ++length) {
        try {
            const KeyExport parsed = parse_export("file", text.substr(0, length));
            EXPECT_EQ(parsed.keys.server_public_key, exported.keys.server_public_key) << length;
            EXPECT_EQ(length + 1, text.size());
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
        }
    }
    EXPECT_EQ(parse_export("file", text).keys.own.secret_key, exported.keys.own.secret_key);
}

TEST_F(KeyFiles, ABitFlippedInAnOwnKeyIsNoticed) {
    const KeyExport exported{
        .name = "x", .role = Role::Node, .keys = {make_key_pair(), keys_.master().public_key}};
    const std::string text = export_text(exported);
    for (const std::string& key : {exported.keys.own.public_key, exported.keys.own.secret_key}) {
        const std::size_t place = text.find(key);
        for (const std::size_t offset : {0u, 5u, 20u}) {
            std::string flipped = text;
            flipped[place + offset] = flipped[place + offset] == 'a' ? 'b' : 'a';
            EXPECT_THROW(parse_export("file", flipped), Error) << offset;
        }
    }
}

TEST_F(KeyFiles, HugeFilesAreNotRead) {
    const auto file = folder_ / "huge.key";
    write_text(file, "", Visibility::Owner);
    std::filesystem::resize_file(file, std::uintmax_t{1} << 40);
    EXPECT_EQ(error_of([&] { KeyDirectory(file).client("x"); }).first, ErrorCode::InvalidInput);
}

}  // namespace

}  // namespace tessera::net
