#include "client/import/limited_process.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <fstream>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "client/import/scene_transfer.h"
#include "mediator/base/random.h"
#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

// Readers in child processes: what they return, and every way in which they can fail.
namespace tessera::import {
namespace {

using namespace std::chrono_literals;

constexpr ProcessLimits Ample{.memory = 1ull << 30, .processor_time = 60s, .wall_time = 60s};

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

// Expects that the child fails while it is read.
Error failure_of(const ProcessLimits& limits, const std::function<void(const ByteSink&)>& produce) {
    try {
        run_limited(limits, produce, [](const ByteSource& source) {
            std::array<std::byte, 1> byte{};
            for (;;) source(byte);
        });
    } catch (const Error& error) {
        return error;
    }
    return {ErrorCode::Internal, "no error"};
}

TEST(LimitedProcess, ReturnsWhatTheChildWrites) {
    const std::string text(5'000'000, 'x');
    std::string read(text.size() + 3, ' ');
    run_limited(
        Ample,
        [&](const ByteSink& sink) {
            sink(bytes_of("abc"));
            sink(bytes_of(text));
        },
        [&](const ByteSource& source) {
            source(std::as_writable_bytes(std::span(read).first(1000)));  // pieces need not match
            source(std::as_writable_bytes(std::span(read).subspan(1000)));
        });
    EXPECT_EQ(read, "abc" + text);
}

TEST(LimitedProcess, WorksWhileOtherThreadsAllocate) {
    std::atomic<bool> end = false;
    std::vector<std::jthread> threads;
    for (int i = 0; i < 3; ++i) {
        threads.emplace_back([&end] {
            while (!end) std::vector<std::string>(100, std::string(100, 'x'));
        });
    }
    for (int round = 0; round < 30; ++round) {
        std::string read(1000, ' ');
        run_limited(
            Ample, [](const ByteSink& sink) { sink(bytes_of(std::string(1000, 'y'))); },
            [&](const ByteSource& source) { source(std::as_writable_bytes(std::span(read))); });
        EXPECT_EQ(read, std::string(1000, 'y'));
    }
    end = true;
}

TEST(LimitedProcess, ErrorsOfTheChildAreThrownHere) {
    const Error error = failure_of(Ample, [](const ByteSink& sink) {
        sink(bytes_of("some"));
        throw Error(ErrorCode::NotFound, "it lacks a thing: add it");
    });
    EXPECT_EQ(error.code(), ErrorCode::NotFound);
    EXPECT_STREQ(error.what(), "it lacks a thing: add it");
    EXPECT_EQ(failure_of(Ample, [](const ByteSink&) { throw std::bad_alloc(); }).code(),
              ErrorCode::OutOfMemory);
    EXPECT_THAT(failure_of(Ample, [](const ByteSink&) { throw std::runtime_error("odd"); }).what(),
                testing::HasSubstr("(odd)"));
}

TEST(LimitedProcess, ACrashIsAnError) {
    const Error error = failure_of(Ample, [](const ByteSink&) { ::raise(SIGSEGV); });
    EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
    EXPECT_THAT(error.what(), testing::HasSubstr("crashed (Segmentation fault)"));
    EXPECT_THAT(failure_of(Ample, [](const ByteSink&) { ::_exit(0); }).what(), testing::HasSubstr("crashed"));
    EXPECT_EQ(failure_of(Ample, [](const ByteSink&) { ::raise(SIGTERM); }).code(), ErrorCode::Unavailable);
}

TEST(LimitedProcess, TooMuchTimeIsAnError) {
    ProcessLimits limits = Ample;
    limits.processor_time = 1s;
    EXPECT_THAT(failure_of(limits,
                           [](const ByteSink&) {
                               for (std::atomic<int> count = 0;; ++count) continue;
                           })
                    .what(),
                testing::HasSubstr("more than 1 s"));
    limits = Ample;
    limits.wall_time = 1s;
    const auto start = std::chrono::steady_clock::now();
    EXPECT_THAT(failure_of(limits,
                           [](const ByteSink&) {
                               for (;;) ::pause();
                           })
                    .what(),
                testing::HasSubstr("more than 1 s"));
    EXPECT_LT(std::chrono::steady_clock::now() - start, 30s);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(LimitedProcess, TooMuchMemoryIsAnError) {
    ProcessLimits limits = Ample;
    limits.memory = 64 << 20;
    const Error error = failure_of(limits, [](const ByteSink& sink) {
        const std::vector<std::byte> bytes(1 << 30);
        sink(bytes);
    });
    EXPECT_EQ(error.code(), ErrorCode::OutOfMemory);
    EXPECT_THAT(error.what(), testing::HasSubstr("64 MiB"));
}
#endif

bool runs(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    std::string number, name, state;
    return (file >> number >> name >> state) && state != "Z";
}

TEST(LimitedProcess, TheChildDiesWithItsParent) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t parent = ::fork();
    if (parent == 0) {
        run_limited(
            Ample,
            [](const ByteSink& sink) {
                const pid_t self = ::getpid();
                sink(std::as_bytes(std::span(&self, 1)));
                for (;;) ::pause();
            },
            [&](const ByteSource& source) {
                pid_t child = 0;
                source(std::as_writable_bytes(std::span(&child, 1)));
                if (::write(ends[1], &child, sizeof child) != sizeof child) ::_exit(1);
                source(std::as_writable_bytes(std::span(&child, 1)));
            });
        ::_exit(0);
    }
    pid_t child = 0;
    ASSERT_EQ(::read(ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
    EXPECT_TRUE(runs(child));
    ::kill(parent, SIGTERM);  // as an interrupt of a program
    ::waitpid(parent, nullptr, 0);
    for (int i = 0; i < 1000 && runs(child); ++i) std::this_thread::sleep_for(10ms);
    EXPECT_FALSE(runs(child));
    for (const int end : ends) ::close(end);
}

TEST(SceneTransfer, DamagedBytesAreAnErrorOrAScene) {
    const TestFolder folder;
    const ImportOptions options;
    SceneBuilder sent(options);
    MeshData mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    const ObjectId material = sent.add(scene::Material{});
    scene::Transform transform;
    const ObjectId geometry = sent.add_geometry("mesh", material, mesh);
    transform.children = {geometry};
    sent.result().root.children = {sent.add(std::move(transform))};
    sent.notice("a notice");
    std::vector<std::byte> whole;
    send_scene(sent.result(), [&](std::span<const std::byte> bytes) {
        whole.insert(whole.end(), bytes.begin(), bytes.end());
    });
    const auto received = [&](std::span<const std::byte> rest, SceneBuilder& builder) {
        try {
            receive_scene(
                [&](std::span<std::byte> bytes) {
                    if (bytes.size() > rest.size()) throw Error(ErrorCode::InvalidInput, "too short");
                    std::copy_n(rest.begin(), bytes.size(), bytes.begin());
                    rest = rest.subspan(bytes.size());
                },
                builder);
            return true;
        } catch (const Error&) {
            return false;
        } catch (const std::bad_alloc&) {
            return false;
        }
    };
    SceneBuilder same(options);
    ASSERT_TRUE(received(whole, same));
    EXPECT_EQ(same.result().objects.size(), 3u);
    EXPECT_EQ(same.result().counts.triangles, 1u);
    EXPECT_THAT(same.result().notices, testing::ElementsAre("a notice"));
    EXPECT_EQ(same.bounds(geometry).upper.x, 1.0);
    CounterRandom random(5);
    int refused = 0;
    for (int round = 0; round < 500; ++round) {
        std::vector<std::byte> damaged = whole;
        if (round % 5 == 0) damaged.resize(random.below(damaged.size()));
        if (!damaged.empty()) damaged[random.below(damaged.size())] ^= std::byte(1u << random.below(8));
        SceneBuilder builder(options);
        refused += received(damaged, builder) ? 0 : 1;
    }
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace tessera::import
