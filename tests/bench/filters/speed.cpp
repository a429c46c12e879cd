#include "tests/bench/filters/speed.h"

#include <algorithm>
#include <array>

#include "tests/bench/filters/film_groups.h"
#include "tests/bench/filters/filter_run.h"

namespace tessera::tools::bench {

namespace {

// Times published in the theses.
struct Published {
    const char* filter;
    Size size;
    double seconds;
    const char *hardware, *source;
};
constexpr std::array PublishedTimes{
    Published{"pixel:method=brute", {1024, 1024}, 0.340, "GeForce GTX 470", "Schwenk"},
    Published{"fdf", {800, 800}, 0.200, "GeForce GTX 1080", "Lardinoije"},
    Published{"psvgf", {1280, 720}, 0.00592, "GeForce GTX 760", "Dundr"},
    Published{"psvgf", {1280, 720}, 0.0246, "Intel HD 530", "Dundr"},
};

class SpeedBench {
  public:
    SpeedBench(const BenchScene& scene, const BenchPlan& plan, tbb::task_arena& arena,
               const BenchProgress& progress, const std::stop_token& stop)
        : scene_(scene),
          plan_(plan),
          arena_(arena),
          progress_(progress),
          stop_(stop),
          sampler_(scene, arena) {}

    std::optional<SpeedResult> run() {
        const auto [width, height] = plan_.sizes.back().size;
        SpeedResult result{.scene = scene_.name, .width = width, .height = height};
        if (!measure_published(result) || !measure_variants(result)) return std::nullopt;
        return result;
    }

  private:
    // Inputs from the film that the filter needs; reused if it is the previous one.
    const filter::Inputs* inputs(const filter::Choice& choice, Size size) {
        progress_.say("speed of " + to_text(choice) + " at " + std::to_string(size.width) + "x" +
                      std::to_string(size.height));
        const view::View view = sampler_.view(size.width, size.height, filter::wanted_channels(choice, {}),
                                              choice.entry->description.path_class, 0);
        if (view == view_) return &inputs_;
        GrowingFilm film = sampler_.film(view);
        if (!sampler_.grow(film, SpeedSpp, stop_)) return nullptr;
        inputs_ = filter::make_inputs(film.whole(), view);
        view_ = view;
        return &inputs_;
    }

    bool measure_published(SpeedResult& result) {
        for (const Published& published : PublishedTimes) {
            const std::string text = published.filter;
            const std::string name = text.substr(0, text.find(':'));
            const auto entry =
                std::find_if(plan_.filters.begin(), plan_.filters.end(),
                             [&](const auto& choice) { return choice.entry->description.name == name; });
            if (entry == plan_.filters.end()) continue;
            const auto choice = filter::parse_choice(text, std::span(entry->entry, 1));
            if (!choice) continue;  // the parameter no longer exists
            const filter::Inputs* film = inputs(*choice, published.size);
            if (!film) return false;
            FilterRun run(*choice, published.size.width, published.size.height, arena_);
            run.picture(*film);
            result.published.push_back({text, published.size.width, published.size.height,
                                        run.time(*film, 0.0).seconds, published.seconds, published.hardware,
                                        published.source});
        }
        return true;
    }

    bool measure_variants(SpeedResult& result) {
        const auto [width, height] = plan_.sizes.back().size;
        std::optional<ReferencePair> pair;
        for (const filter::Choice& standard : plan_.filters) {
            const std::vector<filter::Choice> others = variants(standard);
            if (others.empty()) continue;
            if (!pair) {
                pair = references({.scene = scene_.name,
                                   .content = to_hex(scene_.content.state_hash()),
                                   .view = sampler_.view(width, height, {}, view::PathClass::Indirect, 0),
                                   .spp = plan_.sizes.back().reference_spp},
                                  sampler_, ReferenceCache(plan_.references), {progress_.say, progress_.warn},
                                  stop_);
                if (!pair) return false;
            }
            std::vector<filter::Choice> all{standard};
            all.insert(all.end(), others.begin(), others.end());
            for (const filter::Choice& choice : all) {
                const filter::Inputs* film = inputs(choice, plan_.sizes.back().size);
                if (!film) return false;
                FilterRun run(choice, width, height, arena_);
                const frame::Image picture = run.picture(*film);
                result.variants.push_back(
                    {to_text(choice), run.time(*film, 0.0), squared_errors(picture, *pair).relmse});
            }
        }
        return true;
    }

    const BenchScene& scene_;
    const BenchPlan& plan_;
    tbb::task_arena& arena_;
    const BenchProgress& progress_;
    const std::stop_token& stop_;
    Sampler sampler_;
    view::View view_{.width = 0};
    filter::Inputs inputs_;
};

}  // namespace

std::vector<filter::Choice> variants(const filter::Choice& choice) {
    std::vector<filter::Choice> found;
    const auto& parameters = choice.entry->description.parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const auto& choices = parameters[i].choices;
        if (std::find(choices.begin(), choices.end(), "off") != choices.end()) continue;
        for (std::size_t value = 0; value < choices.size(); ++value) {
            if (double(value) == choice.values[i]) continue;
            found.push_back(choice);
            found.back().values[i] = double(value);
        }
    }
    return found;
}

std::optional<SpeedResult> measure_speed(const BenchScene& scene, const BenchPlan& plan,
                                         tbb::task_arena& arena, const BenchProgress& progress,
                                         const std::stop_token& stop) {
    return SpeedBench(scene, plan, arena, progress, stop).run();
}

}  // namespace tessera::tools::bench
