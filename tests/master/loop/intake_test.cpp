#include "master/loop/intake.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

using namespace std::chrono_literals;

net::Message message_of(const std::string& user, std::size_t bytes = 1) {
    net::Message message{.link = net::Link::Control, .role = net::Role::Viewer};
    message.user = user;
    message.bytes.resize(bytes);
    return message;
}

bool put(Intake& intake, const std::string& user, std::size_t bytes = 1) {
    net::Message message = message_of(user, bytes);
    return intake.put(message);
}

TEST(Intake, AFloodDelaysItsOwnKeyOnly) {
    Intake intake;
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(put(intake, "flooder"));
    (void)intake.take();
    intake.used("flooder", 10ms);
    ASSERT_TRUE(put(intake, "editor"));
    EXPECT_EQ(intake.take().user, "editor") << "it has used less";
}

// Time, not messages: who asks for what is costly gets fewer turns.
TEST(Intake, SharesTheTimeOfTheLoopEvenly) {
    Intake intake;
    for (int i = 0; i < 2000; ++i) {
        ASSERT_TRUE(put(intake, "costly"));
        ASSERT_TRUE(put(intake, "cheap"));
    }
    int costly = 0, cheap = 0;
    for (int i = 0; i < 1100; ++i) {
        const net::Message message = intake.take();
        const bool is_costly = message.user == "costly";
        ++(is_costly ? costly : cheap);
        intake.used(message.user, is_costly ? 10ms : 1ms);
    }
    EXPECT_NEAR(cheap, 10 * costly, 11);
}

TEST(Intake, AKeyThatWasSilentDoesNotSaveUpTime) {
    Intake intake;
    for (int i = 0; i < 100; ++i) {
        ASSERT_TRUE(put(intake, "busy"));
        (void)intake.take();
        intake.used("busy", 10ms);
    }
    for (int i = 0; i < 100; ++i) {
        ASSERT_TRUE(put(intake, "busy"));
        ASSERT_TRUE(put(intake, "late"));
    }
    int busy = 0;
    for (int i = 0; i < 40; ++i) {
        const net::Message message = intake.take();
        busy += message.user == "busy" ? 1 : 0;
        intake.used(message.user, 10ms);
    }
    EXPECT_GE(busy, 19);
}

TEST(Intake, IsBoundedPerKeyAndKeepsTheOrder) {
    Intake intake;
    std::size_t taken = 0;
    while (put(intake, "flooder", 1 + taken)) ++taken;
    EXPECT_LE(taken, Intake::MaxMessages);
    EXPECT_FALSE(put(intake, "flooder", Intake::MaxBytes));
    EXPECT_TRUE(put(intake, "other"));
    std::size_t last = 0;
    while (!intake.empty()) {
        const net::Message message = intake.take();
        if (message.user != "flooder") continue;
        EXPECT_EQ(message.bytes.size(), last + 1);
        last = message.bytes.size();
    }
    EXPECT_EQ(last, taken);
    EXPECT_TRUE(put(intake, "flooder", 1)) << "there is room again";
}

}  // namespace
}  // namespace tessera::master
