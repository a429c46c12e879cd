// Files and shared memory of headless outputs, and options that tessera-display rejects.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>

#include "client/display/shared_memory.h"
#include "tests/process/display_cluster.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using client_display::SharedHeader;

// Another process' view of the shared memory.
class Reader {
  public:
    explicit Reader(const std::string& name) {
        const int file = ::shm_open(name.c_str(), O_RDONLY, 0);
        if (file < 0) return;
        byte_size_ = static_cast<std::size_t>(::lseek(file, 0, SEEK_END));
        void* const place = ::mmap(nullptr, byte_size_, PROT_READ, MAP_SHARED, file, 0);
        ::close(file);
        if (place != MAP_FAILED) place_ = static_cast<const std::uint8_t*>(place);
    }
    ~Reader() {
        if (place_ != nullptr) ::munmap(const_cast<std::uint8_t*>(place_), byte_size_);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    bool is_there() const { return place_ != nullptr; }
    const SharedHeader& header() const { return *reinterpret_cast<const SharedHeader*>(place_); }
    std::size_t picture_bytes() const {
        return std::size_t{3} * header().picture_count * header().width * header().height;
    }
    std::vector<std::uint8_t> buffer(std::uint64_t sequence) const {
        const std::uint8_t* const start = place_ + sizeof(SharedHeader) + sequence % 3 * picture_bytes();
        return {start, start + picture_bytes()};
    }

  private:
    const std::uint8_t* place_ = nullptr;
    std::size_t byte_size_ = 0;
};

std::string shared_name() {
    return "/tessera-test-" + std::to_string(::getpid());
}

TEST(SharedMemory, ShownBufferIsIntactWhileTheNextIsWritten) {
    display::Output output{.name = "a", .width = 5, .height = 3};
    output.stereo = display::Stereo::Separate;
    const auto presenter = client_display::make_shared_memory(shared_name(), output);
    const Reader reader(shared_name());
    ASSERT_TRUE(reader.is_there());
    EXPECT_EQ(reader.header().sequence, 0u);
    EXPECT_EQ(reader.header().picture_count, 2u);
    const auto picture = [&](int frame, int eye) {
        return std::vector<std::uint8_t>(45, static_cast<std::uint8_t>(10 * frame + eye));
    };
    const auto both = [&](int frame) {
        std::vector<std::uint8_t> bytes = picture(frame, 0);
        const auto right = picture(frame, 1);
        bytes.insert(bytes.end(), right.begin(), right.end());
        return bytes;
    };
    for (int frame = 1; frame < 9; ++frame) {
        presenter->prepare(std::vector{picture(frame, 0), picture(frame, 1)});
        // The shown buffer and the previous one, which another process may still be reading.
        for (int before = std::max(1, frame - 2); before < frame; ++before) {
            EXPECT_EQ(reader.buffer(std::uint64_t(before)), both(before)) << "while " << frame << " is made";
            EXPECT_EQ(reader.header().frames[std::size_t(before) % 3], 100u + unsigned(before));
        }
        presenter->present(100u + unsigned(frame));
        EXPECT_EQ(reader.header().sequence, unsigned(frame));
        EXPECT_EQ(reader.buffer(unsigned(frame)), both(frame));
    }
}

struct OutputPictures : testing::Test {
    DisplayCluster wall{1};
    display::Display display{.name = "wall", .spp = 4, .rate = 60.0};

    // The output of a tessera-display that exits by itself.
    struct Ended {
        int code = 0;
        std::string text;
    };
    Ended ended(const std::vector<std::string>& arguments, const std::vector<std::string>& variables = {}) {
        ChildProcess process = start_with(variables, wall.folder(), "refused", "tessera-display", arguments);
        const int code = process.wait(60s).value_or(-1);
        return {code, process.out() + process.err()};
    }
};

TEST_F(OutputPictures, FilesAreAlwaysComplete) {
    display.outputs = {part_of_wall("mono", -2, 0), part_of_wall("both", 0, 2)};
    display.outputs[1].stereo = display::Stereo::Separate;
    wall.editor().open_display(display);
    const std::string shown = wall.folder() / "shown";
    ChildProcess mono = wall.show("mono", {"--png", shown}), both = wall.show("both", {"--png", shown});
    ASSERT_TRUE(wall.wait_until_the_same_is_shown({"mono", "both"})) << mono.err() << both.err();
    const MovingScene moving(wall);
    for (const std::string name : {"mono", "both-left", "both-right"}) {
        int changes = 0;
        std::vector<std::uint8_t> last;
        EXPECT_TRUE(happens([&] {
            for (int i = 0; i < 20; ++i) {
                std::vector<std::uint8_t> now = png_bytes(shown + "/" + name + ".png", 64, 48);
                if (now != last) ++changes;
                last = std::move(now);
            }
            return changes >= 10 || HasFailure();
        })) << name
            << " does not change";
    }
    EXPECT_FALSE(std::filesystem::exists(shown + "/both.png"));
}

TEST_F(OutputPictures, SharedMemoryHasThePictureOfTheFile) {
    display.outputs = {part_of_wall("mono", -1, 1)};
    wall.editor().open_display(display);
    const auto expected = wall.finished_png(display.outputs[0], display.spp);
    ChildProcess process = wall.show("mono", {"--shm", shared_name()});
    ASSERT_TRUE(happens([&] { return Reader(shared_name()).is_there(); })) << process.err();
    const Reader reader(shared_name());
    EXPECT_TRUE(happens([&] {
        const std::uint64_t sequence = reader.header().sequence;
        return sequence > 0 && reader.buffer(sequence) == expected;
    }));
    EXPECT_EQ(reader.header().width, 64u);
    EXPECT_EQ(reader.header().height, 48u);
    EXPECT_TRUE(happens([&] {
        return wall.log("mono").back().frame == reader.header().frames[reader.header().sequence % 3];
    }));
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait(30s).value_or(-1), 0);
    EXPECT_FALSE(Reader(shared_name()).is_there()) << "it is left behind";
}

TEST_F(OutputPictures, PatternIsToggled) {
    display.outputs = {part_of_wall("mono", -1, 1)};
    wall.editor().open_display(display);
    const auto scene = wall.finished_png(display.outputs[0], display.spp);
    const std::string shown = wall.folder() / "shown";
    ChildProcess process = wall.show("mono", {"--png", shown});
    const auto shows = [&] { return png_bytes(shown + "/mono.png", 64, 48); };
    ASSERT_TRUE(happens([&] { return std::filesystem::exists(shown + "/mono.png"); })) << process.err();
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(happens([&] { return shows() == scene; })) << process.err();
        wall.editor().adjust_display({.pattern = true});
        EXPECT_TRUE(happens([&] { return shows() != scene; }));
        wall.editor().adjust_display({.pattern = false});
    }
    EXPECT_TRUE(happens([&] { return shows() == scene; })) << process.err();
    EXPECT_TRUE(process.running());
}

TEST_F(OutputPictures, WrongOptionsAreRejectedWithARemedy) {
    const auto refused = [&](const std::vector<std::string>& arguments, const std::string& text) {
        const Ended end = ended(arguments);
        EXPECT_EQ(end.code, 64) << text;
        EXPECT_NE(end.text.find(text), std::string::npos) << end.text;
    };
    refused({}, "--output");
    refused({"--output", "a", "--hedless"}, "--headless");
    refused({"--output", "a", "--png", "shown"}, "require --headless");
    refused({"--output", "a", "--shm", "/a"}, "require --headless");
    refused({"--output", "a", "--headless", "--window"}, "exclude each other");
    refused({"--output", "a", "--headless", "--shm", "/a/b"}, "as /left");
    refused({"--output", "a", "--headless", "--shm", "/a", "--png", "b"}, "exclude each other");
}

TEST_F(OutputPictures, NoFileIsWrittenOutsideTheFolder) {
    for (const std::string name : {"../outside", "in/side", ".hidden"}) {
        display.outputs = {part_of_wall(name, -1, 1)};
        wall.editor().open_display(display);
        const Ended end = ended(wall.arguments(name, {"--headless", "--png", wall.folder() / "shown"}));
        EXPECT_EQ(end.code, 2) << end.text;
        EXPECT_NE(end.text.find("rename it"), std::string::npos) << end.text;
    }
    EXPECT_FALSE(std::filesystem::exists(wall.folder() / "shown"));
    EXPECT_FALSE(std::filesystem::exists(wall.folder() / "outside.png"));
}

TEST_F(OutputPictures, MissingScreenErrorSuggestsHeadless) {
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--window"}}) {
        const Ended end = ended(wall.arguments("a", more), {"-u", "DISPLAY", "-u", "WAYLAND_DISPLAY"});
        EXPECT_EQ(end.code, 69) << end.text;
        EXPECT_NE(end.text.find("--headless"), std::string::npos) << end.text;
    }
}

TEST_F(OutputPictures, ViewerKeyIsAcceptedAndNodeKeyIsRejected) {
    display.outputs = {part_of_wall("a", -1, 1)};
    wall.editor().open_display(display);
    ChildProcess viewer = wall.show("a", {"--user", "viewer"});
    EXPECT_TRUE(wall.wait_for_state("a", "locked")) << viewer.err();
    const Ended node = ended(wall.arguments("a", {"--headless", "--user", "node"}));
    EXPECT_EQ(node.code, 77) << node.text;
    EXPECT_NE(node.text.find("role node"), std::string::npos) << node.text;
}

TEST_F(OutputPictures, WaitsForAMasterUntilStopped) {
    const std::string elsewhere = free_loopback_endpoint();
    ChildProcess process(wall.folder().path(), "waits", "tessera-display",
                         {"--master", elsewhere, "--output", "a", "--headless"});
    EXPECT_TRUE(happens([&] { return process.err().find("Waiting") != std::string::npos; }));
    EXPECT_TRUE(process.running());
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait(30s).value_or(-1), 130);
}

}  // namespace
}  // namespace tessera::test
