// `tessera bench filters`: kept references, the plan, and a small run from scenes to the reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "master/filter/catalog.h"
#include "tests/bench/filters/advice.h"
#include "tests/bench/filters/bench_files.h"
#include "tests/bench/filters/html_report.h"
#include "tests/bench/filters/json_report.h"
#include "tests/bench/filters/plan.h"
#include "tests/bench/filters/references.h"
#include "tests/bench/filters/run_bench.h"
#include "tests/bench/filters/speed.h"

namespace tessera::tools::bench {
namespace {

namespace fs = std::filesystem;

class Folder {
  public:
    Folder() : path_(fs::temp_directory_path() / ("tessera-bench-test-" + std::to_string(::getpid()))) {
        fs::remove_all(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

frame::FilmTile small_film() {
    frame::FilmTile film({0, 0, 8, 4}, {0, 0}, {frame::Channel::Radiance});
    for (std::size_t i = 0; i < film.planes.size(); ++i) film.planes[i] = 0.01f * static_cast<float>(i);
    std::fill(film.counts.begin(), film.counts.end(), 4u);
    return film;
}

TEST(BenchReferences, RoundTrip) {
    const Folder folder;
    const ReferenceCache cache(folder.path());
    EXPECT_EQ(cache.load("a", "key").error().code(), ErrorCode::NotFound);
    cache.store("a", "key", small_film());
    const auto film = cache.load("a", "key");
    ASSERT_TRUE(film) << film.error().what();
    EXPECT_EQ(film->planes, small_film().planes);
    EXPECT_EQ(film->counts, small_film().counts);
}

TEST(BenchReferences, OfOtherScenesAreRejected) {
    const Folder folder;
    const ReferenceCache cache(folder.path());
    cache.store("a", "key", small_film());
    const auto film = cache.load("a", "another key");
    ASSERT_FALSE(film);
    EXPECT_EQ(film.error().code(), ErrorCode::NotFound);
}

TEST(BenchReferences, DamagedFilesAreRejected) {
    const Folder folder;
    const ReferenceCache cache(folder.path());
    cache.store("a", "key", small_film());
    const fs::path file = folder.path() / "a.exr";
    fs::resize_file(file, fs::file_size(file) - 100);
    ASSERT_FALSE(cache.load("a", "key"));
    EXPECT_EQ(cache.load("a", "key").error().code(), ErrorCode::InvalidInput);
    std::ofstream(file) << "no picture";
    ASSERT_FALSE(cache.load("a", "key"));
    EXPECT_EQ(cache.load("a", "key").error().code(), ErrorCode::InvalidInput);
}

TEST(BenchReferences, AChangedByteNeverChangesThePicture) {
    const Folder folder;
    const ReferenceCache cache(folder.path());
    cache.store("a", "key", small_film());
    const fs::path file = folder.path() / "a.exr";
    const auto size = static_cast<std::streamoff>(fs::file_size(file));
    int refused = 0;
    for (std::streamoff at = size / 3; at < size; at += 7) {
        const auto flip = [&] {
            std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
            stream.seekg(at);
            const char byte = static_cast<char>(stream.get() ^ 0x10);
            stream.seekp(at);
            stream.put(byte);
        };
        flip();
        const auto film = cache.load("a", "key");
        if (film) {
            EXPECT_EQ(film->planes, small_film().planes) << at;
        } else {
            ++refused;
        }
        flip();
    }
    EXPECT_GT(refused, 0);
    EXPECT_TRUE(cache.load("a", "key"));
}

TEST(BenchPlan, ParsesFilterLists) {
    BenchOptions options;
    options.scenes = "cornell,grids";
    options.filters = "gauss:sigma=3,gauss";
    options.spp = "16,4,16";
    const auto plan = parse_options(options, filter::catalog());
    ASSERT_TRUE(plan) << plan.error().what();
    ASSERT_EQ(plan->filters.size(), 3u);
    EXPECT_EQ(to_text(plan->filters[0]), "none");
    EXPECT_EQ(to_text(plan->filters[1]), "gauss:sigma=3");
    EXPECT_EQ(to_text(plan->filters[2]), "gauss");
    EXPECT_EQ(plan->sizes.front().spp, (std::vector<std::uint64_t>{4, 16}));
    options.filters.clear();
    const auto all = parse_options(options, filter::catalog());
    EXPECT_EQ(all->filters.size() + all->left_out.size(), filter::catalog().size());
}

TEST(BenchPlan, LeavesOutFiltersThatThisMachineCannotRun) {
    std::vector<filter::FilterEntry> table(filter::catalog().begin(), filter::catalog().end());
    table.resize(3);
    table[2].why_unavailable = [] { return std::string("it needs a library"); };
    const std::string name(table[2].description.name);
    BenchOptions options;
    options.scenes = "cornell";
    const auto all = parse_options(options, table);
    ASSERT_TRUE(all) << all.error().what();
    EXPECT_EQ(all->filters.size(), 2u);
    EXPECT_EQ(all->left_out, std::vector<std::string>{name + " is left out: it needs a library"});
    options.filters = name;
    const auto named = parse_options(options, table);
    ASSERT_FALSE(named);
    EXPECT_EQ(std::string(named.error().what()), "--filters: it needs a library");
}

TEST(BenchPlan, ErrorsNameTheOption) {
    const auto message = [](const auto& change) {
        BenchOptions options;
        options.scenes = "cornell";
        change(options);
        const auto plan = parse_options(options, filter::catalog());
        return plan ? std::string() : std::string(plan.error().what());
    };
    EXPECT_EQ(message([](BenchOptions&) {}), "");
    EXPECT_NE(message([](BenchOptions& o) { o.spp = "4,zero"; }).find("zero"), std::string::npos);
    EXPECT_NE(message([](BenchOptions& o) { o.spp = "0"; }).find("--spp"), std::string::npos);
    EXPECT_NE(message([](BenchOptions& o) { o.size = "12"; }).find("--size"), std::string::npos);
    EXPECT_NE(message([](BenchOptions& o) { o.scenes = "cornel"; }).find("cornell"), std::string::npos);
    EXPECT_NE(message([](BenchOptions& o) { o.filters = "gaus"; }).find("--filters"), std::string::npos);
    EXPECT_NE(message([](BenchOptions& o) { o.reference_spp = 0; }).find("--reference-spp"),
              std::string::npos);
}

// Made-up measurements of two filters: `sharp` is equivalent to 4 times the samples, `smear` has an error that stays.
BenchResults made_up() {
    BenchResults results{.software = "tessera", .threads = 2};
    results.filters = {{.text = "none", .name = "none", .is_consistent = true},
                       {.text = "sharp", .name = "sharp", .is_consistent = true},
                       {.text = "smear<&>", .name = "smear"}};
    SizeResult size{.width = 8, .height = 4};
    for (const std::uint64_t spp : {1u, 4u, 16u}) {
        const double none = 1.0 / double(spp), smear = 0.05;
        const auto row = [&](const char* name, double error) {
            Row made{.filter = name, .spp = spp};
            made.errors.relmse = {{error, 0.001}, {error, 0.001}};
            made.all = made.trimmed = {error / none, {none / error, true}, {none / error, true}};
            made.crop.assign(8 * 4 * 3, 128);
            size.rows.push_back(made);
        };
        row("none", none);
        row("sharp", none / 4.0);
        row("smear<&>", smear);
    }
    size.crop_width = 8;
    size.crop_height = 4;
    size.reference_crop.assign(8 * 4 * 3, 255);
    results.scenes.push_back({"box", "test", "a box", "0", {size}, {}});
    results.speed = {.scene = "box", .width = 8, .height = 4};
    results.speed.published.push_back({"sharp", 8, 4, 0.1, 0.2, "a card", "a thesis"});
    results.speed.variants.push_back({"sharp:way=long", {.seconds = 0.3}, {}});
    return results;
}

TEST(BenchAdvice, MatchesTheNumbers) {
    const BenchResults results = made_up();
    EXPECT_EQ(least_error(results.scenes[0], 1)->row->filter, "smear<&>");
    EXPECT_EQ(least_error(results.scenes[0], 16)->row->filter, "sharp");
    const auto found = convergence(results);
    ASSERT_EQ(found.size(), 3u);
    EXPECT_TRUE(found[1].exceeded.empty());
    EXPECT_NEAR(found[1].worst, 0.25, 1e-9);
    EXPECT_TRUE(found[2].exceeded.empty());  // 0.8 at 16 samples: not yet worse
    EXPECT_EQ(found[2].worst_spp, 16u);
    EXPECT_EQ(standings(results, 16).front().filter, "sharp");
    EXPECT_NEAR(standings(results, 16).front().ratio, 4.0, 1e-9);
}

TEST(BenchAdvice, NamesInferiorFilters) {
    BenchResults results = made_up();
    for (Row& row : results.scenes[0].sizes[0].rows) {
        if (row.filter == "smear<&>" && row.spp == 16) row.trimmed.to_unfiltered = 1.06;
    }
    const auto found = convergence(results);
    ASSERT_EQ(found[2].exceeded.size(), 1u);
    EXPECT_EQ(found[2].exceeded[0].spp, 16u);
    bool is_said = false;
    for (const std::string& sentence : advice(results)) {
        is_said |= sentence.find("Worse than no filter") != std::string::npos &&
                   sentence.find("smear<&> from 16 spp") != std::string::npos;
    }
    EXPECT_TRUE(is_said);
}

TEST(BenchHtml, ContainsEveryFilterAndEscapesText) {
    const std::string html = as_html(made_up());
    for (const char* name : {">sharp<", ">none<", "smear&lt;&amp;&gt;"}) {
        EXPECT_NE(html.find(name), std::string::npos) << name;
    }
    EXPECT_EQ(html.find("smear<&>"), std::string::npos);
    EXPECT_EQ(html.find("src=\"http"), std::string::npos);
    EXPECT_NE(html.find("data:image/png;base64,iVBOR"), std::string::npos);
}

TEST(BenchHtml, QuotesThePublishedTimes) {
    const std::string html = as_html(made_up());
    EXPECT_NE(html.find("a card"), std::string::npos);
    EXPECT_NE(html.find("sharp:way=long"), std::string::npos);
}

TEST(BenchSpeed, VariantsAreTheAlternativeMethods) {
    const auto everything = variants(*filter::parse_choice("pixel", filter::catalog()));
    std::vector<std::string> names;
    for (const filter::Choice& choice : everything) names.push_back(to_text(choice));
    EXPECT_NE(std::ranges::find(names, "pixel:method=brute"), names.end());
    EXPECT_EQ(std::ranges::find(names, "pixel"), names.end());
    EXPECT_TRUE(variants(*filter::parse_choice("none", filter::catalog())).empty());
}

TEST(BenchHtml, Base64) {
    const auto encoded = [](std::string_view text) { return base64(std::as_bytes(std::span(text))); };
    EXPECT_EQ(encoded(""), "");
    EXPECT_EQ(encoded("f"), "Zg==");
    EXPECT_EQ(encoded("fo"), "Zm8=");
    EXPECT_EQ(encoded("foo"), "Zm9v");
    EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(BenchFilters, SmallRunWritesReports) {
    const Folder folder;
    BenchOptions options;
    options.output = folder.path().string();
    options.scenes = "cornell";
    options.filters = "none,gauss";
    options.spp = "1,4";
    options.size = "32x18";
    options.large = "48x27";
    options.reference_spp = 16;
    options.jobs = 2;
    auto plan = parse_options(options, filter::catalog());
    ASSERT_TRUE(plan) << plan.error().what();
    plan->path_views = 3;
    plan->measures_speed = false;
    plan->path_reference_spp = 4;
    const BenchFiles files(plan->output);
    int said = 0, warned = 0;
    const BenchProgress progress{.say = [&](const std::string&) { ++said; },
                                 .warn = [&](const std::string&) { ++warned; }};
    const auto results = run_bench(*plan, progress, {});
    ASSERT_TRUE(results);
    EXPECT_GT(said, 0);
    EXPECT_EQ(warned, 0);
    EXPECT_EQ(files.write(*results).size(), 4u);

    const auto json = nlohmann::json::parse(std::ifstream(folder.path() / "filters.json"));
    ASSERT_EQ(json["scenes"].size(), 1u);
    const auto& scene = json["scenes"][0];
    EXPECT_EQ(scene["name"], "cornell");
    ASSERT_EQ(scene["sizes"].size(), 2u);
    const auto& size = scene["sizes"][0];
    EXPECT_GT(size["references"]["noise_relmse"].get<double>(), 0.0);
    EXPECT_GT(size["copy_gigabytes_per_second"].get<double>(), 0.0);
    ASSERT_EQ(size["rows"].size(), 4u);
    for (const auto& row : size["rows"]) {
        for (const char* field : {"filter", "spp", "relmse", "mse", "flip_mean", "ssim", "specks", "energy",
                                  "filter_milliseconds", "sampling_milliseconds", "passes", "bytes_per_pixel",
                                  "time_over_plain_copy", "relmse_over_unfiltered",
                                  "equal_error_sample_ratio", "equal_time_error_ratio", "trimmed"}) {
            EXPECT_TRUE(row.contains(field)) << field;
        }
        EXPECT_GT(row["relmse"]["value"].get<double>(), 0.0);
        EXPECT_GT(row["passes"][0]["bytes_per_pixel"].get<double>(), 0.0);
    }
    EXPECT_EQ(size["rows"][0]["filter"], "none");
    EXPECT_NEAR(size["rows"][0]["equal_error_sample_ratio"]["value"].get<double>(), 1.0, 1e-9);
    EXPECT_EQ(scene["camera_path"]["rows"].size(), 4u);

    // The second run reads its references.
    const auto newest = [&] {
        fs::file_time_type time{};
        for (const auto& entry : fs::directory_iterator(plan->references)) {
            time = std::max(time, entry.last_write_time());
        }
        return time;
    };
    const auto before = newest();
    const auto again = run_bench(*plan, progress, {});
    ASSERT_TRUE(again);
    EXPECT_EQ(newest(), before);
    EXPECT_EQ(again->scenes[0].sizes[0].rows[1].errors.relmse.all.value,
              results->scenes[0].sizes[0].rows[1].errors.relmse.all.value);
}

TEST(BenchFilters, StopEndsTheRun) {
    const Folder folder;
    BenchOptions options;
    options.output = folder.path().string();
    options.scenes = "grids";
    options.filters = "none";
    options.size = "32x18";
    options.large = "none";
    options.jobs = 1;
    const auto plan = parse_options(options, filter::catalog());
    ASSERT_TRUE(plan);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_FALSE(run_bench(*plan, SilentProgress, stop.get_token()));
}

}  // namespace
}  // namespace tessera::tools::bench
