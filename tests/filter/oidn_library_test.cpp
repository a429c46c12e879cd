// Which shared libraries are accepted as Open Image Denoise, and what is said about the others.
#include <gtest/gtest.h>

#include <cstdlib>

#include "master/filter/oidn/library.h"
#include "tests/support/environment.h"
#include "tests/support/folders.h"

namespace tessera::filter::oidn {
namespace {

using test::EnvironmentVariable;

std::string in(const std::string& stand_in, const std::string& file) {
    return (test::open_image_denoise(stand_in) / file).string();
}

Expected<Library> opened(const std::vector<std::string>& files) {
    std::vector<const char*> names;
    for (const std::string& file : files) names.push_back(file.c_str());
    return open_library(names);
}

void expect_problem(const std::vector<std::string>& files, const std::string& part) {
    const auto library = opened(files);
    ASSERT_FALSE(library) << part;
    EXPECT_EQ(library.error().code(), ErrorCode::Unavailable);
    const std::string text = library.error().what();
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_NE(text.find("install Open Image Denoise 1 or 2"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
}

TEST(OidnLibrary, BothVersionsAreAccepted) {
    const auto two = opened({in("oidn", "libOpenImageDenoise.so.2")});
    ASSERT_TRUE(two) << two.error().what();
    EXPECT_EQ(two->version, 20301);
    const auto one = opened({in("oidn-1", "libOpenImageDenoise.so.0")});
    ASSERT_TRUE(one) << one.error().what();
    EXPECT_EQ(one->version, 10403);
}

TEST(OidnLibrary, TheFirstThatIsThereIsTaken) {
    const auto library =
        opened({in("oidn", "libOpenImageDenoise.so.9"), in("oidn-1", "libOpenImageDenoise.so.0"),
                in("oidn", "libOpenImageDenoise.so.2")});
    ASSERT_TRUE(library) << library.error().what();
    EXPECT_EQ(library->version, 10403);
}

TEST(OidnLibrary, TheRunPathOfTheTestLeadsToTheStandIn) {
    const auto library = installed_library();
    ASSERT_TRUE(library) << library.error().what();
    EXPECT_EQ((*library)->name, "libOpenImageDenoise.so.2");
    EXPECT_EQ((*library)->version, 20301);
    EXPECT_EQ(*library, *installed_library());
}

TEST(OidnLibrary, ProblemsAreNamed) {
    expect_problem({}, "it is not installed there");
    expect_problem({in("oidn", "libOpenImageDenoise.so.9")}, "it is not installed there");
    expect_problem({in("oidn-incomplete", "libOpenImageDenoise.so.2")},
                   "libOpenImageDenoise.so.2 cannot be used there: it lacks the function oidnExecuteFilter");
    expect_problem({in("oidn-3", "libOpenImageDenoise.so")}, "it is version 3.0.0, not 1 or 2");
    expect_problem({(test::source_folder() / "LICENSE").string()}, "LICENSE cannot be used there");
    for (const auto& [fails, reason] :
         {std::pair("device", "unsupported device type: CPU"), {"commit device", "the device is lost"}}) {
        const EnvironmentVariable failing("TESSERA_OIDN_FAILS", fails);
        expect_problem({in("oidn", "libOpenImageDenoise.so.2")},
                       std::string("it creates no device for this CPU: ") + reason);
    }
}

TEST(OidnLibrary, AnExecutionIsCancelled) {
    std::vector<float> color(3 * 8 * 4, 0.5f), albedo = color, normal = color, output = color;
    RayTracingFilter filter(shared_device(2));
    filter.set({color, albedo, normal, output}, 8, 4);
    std::stop_source stop;
    EXPECT_TRUE(filter.execute(stop.get_token()));
    stop.request_stop();
    EXPECT_FALSE(filter.execute(stop.get_token()));
    EXPECT_TRUE(filter.execute({})) << "the error of the one before is not its own";
}

TEST(OidnLibrary, FiltersShareADeviceForAsManyThreads) {
    const auto two = shared_device(2);
    EXPECT_EQ(two, shared_device(2));
    EXPECT_NE(two, shared_device(3));
}

}  // namespace
}  // namespace tessera::filter::oidn
