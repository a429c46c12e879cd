// The contract of every filter of the table, for any film.
#include <algorithm>
#include <cmath>

#include "mediator/base/random.h"
#include "tests/contract/filter_cases.h"

namespace tessera::filter::test {
namespace {

using frame::Channel;

void expect_constant(const Planes& picture, const std::string& what) {
    ASSERT_EQ(picture.components(), 4u) << what;
    double worst = 0.0;
    std::string where = "nowhere";
    for (std::uint32_t c = 0; c < 4; ++c) {
        const double expected = c < 3 ? ConstantColor[c] : 1.0;
        for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
            const double error = std::abs(picture.plane(c)[i] / expected - 1.0);
            if (error <= worst) continue;
            worst = error;
            where = "component " + std::to_string(c) + " at (" + std::to_string(i % picture.width()) + ", " +
                    std::to_string(i / picture.width()) + ")";
        }
    }
    EXPECT_LE(worst, 1e-6) << what << ": worst at " << where;
}

TEST_P(FilterContract, AConstantStaysConstant) {
    const auto same = [](auto, auto, auto) { return SyntheticSample{}; };
    const auto varied = [](auto x, auto y, auto i) { return room(40, 30, x, y, i); };
    for (const std::uint64_t n : {1, 4, 64}) {
        for (const bool features_vary : {false, true}) {
            const Inputs inputs = constant_inputs(40, 30, n, features_vary ? Sampler(varied) : Sampler(same));
            Subject subject(entry(), inputs);
            expect_constant(subject.picture(inputs),
                            name() + ", n = " + std::to_string(n) + (features_vary ? ", features vary" : ""));
        }
    }
}

TEST_P(FilterContract, AConstantStaysConstantWhateverTheVariance) {
    Inputs inputs = constant_inputs(40, 30, 16, [](auto x, auto y, auto) { return room(40, 30, x, y, 0); });
    CounterRandom random(11);
    for (Planes& variance : inputs.variances) {
        for (float& value : variance.values()) value = static_cast<float>(0.2 * random.uniform());
    }
    Subject subject(entry(), inputs);
    expect_constant(subject.picture(inputs), name() + ", made-up variances");
}

TEST_P(FilterContract, HolesAreFilledFromTheirNeighbours) {
    if (is_one_of({"none"})) GTEST_SKIP() << "leaves holes as they are, by its definition";
    const Inputs inputs = constant_inputs(40, 30, 4, [](auto x, auto y, auto) {
        return mix(x + 40 * y) % 10 == 0 ? rejected() : SyntheticSample{};
    });
    ASSERT_EQ(std::ranges::count(inputs.counts.plane(0), 0.0f) > 60, true);
    Subject subject(entry(), inputs);
    expect_constant(subject.picture(inputs), name() + ", a tenth of the pixels without samples");
}

TEST_P(FilterContract, IsFiniteWhateverTheFilm) {
    for (const MalformedCase& malformed : malformed_cases()) {
        Subject subject(entry(), malformed.inputs);
        subject.out.wants_maps = true;
        for (int run = 0; run < 2; ++run) {  // the second with a history, where there is one
            const Planes& picture = subject.picture(malformed.inputs);
            ASSERT_EQ(picture.components(), 4u) << name() << ": " << malformed.name;
            ASSERT_EQ(picture.pixel_count(), malformed.inputs.pixel_count())
                << name() << ": " << malformed.name;
            EXPECT_EQ(first_not_finite(picture), "") << name() << ": " << malformed.name << ", run " << run;
            EXPECT_FALSE(subject.report.stopped) << name() << ": " << malformed.name;
        }
    }
}

TEST_P(FilterContract, NeedsOnlyItsOwnChannels) {
    frame::ChannelSet own = entry().description.channels(default_values(entry().description));
    if (entry().description.reads_variances) own.insert(Channel::BlockVariance);
    const Inputs inputs = synthetic_inputs(
        24, 18, 4, [](auto x, auto y, auto i) { return room(24, 18, x, y, i); }, own);
    Subject subject(entry(), inputs);
    EXPECT_EQ(first_not_finite(subject.picture(inputs)), "") << name();
    // Other channels have no effect; alpha is a component of the picture and left out here.
    frame::ChannelSet all = EveryChannel;
    if (!own.contains(Channel::Alpha)) {
        all.erase(Channel::Alpha);
    }
    const Inputs richer = synthetic_inputs(
        24, 18, 4, [](auto x, auto y, auto i) { return room(24, 18, x, y, i); }, all);
    Subject other(entry(), richer);
    EXPECT_EQ(first_difference(subject.out.picture.values(), other.picture(richer).values()), "")
        << name() << " reads channels that its description does not name";
}

TEST_P(FilterContract, ReportsItsPasses) {
    const Inputs inputs = room_inputs(24, 18, 4);
    Subject subject(entry(), inputs);
    subject.picture(inputs);
    ASSERT_FALSE(subject.report.passes.empty()) << name();
    for (const Pass& pass : subject.report.passes) {
        EXPECT_FALSE(pass.name.empty()) << name();
        EXPECT_GT(pass.bytes_per_pixel, 0.0) << name() << ": " << pass.name;
    }
}

// --- alpha

TEST_P(FilterContract, AlphaStaysBetweenZeroAndOne) {
    const Inputs inputs = room_inputs(48, 40, 3);
    Subject subject(entry(), inputs);
    for (const float alpha : subject.picture(inputs).plane(3)) {
        ASSERT_GE(alpha, 0.0f) << name();
        ASSERT_LE(alpha, 1.0f) << name();
    }
}

TEST_P(FilterContract, AlphaHasTheWeightsOfTheRadiance) {
    if (is_one_of({"psvgf"}))
        GTEST_SKIP() << "leaves alpha as sampled: its light never goes from hits to misses";
    // Half of the picture is half covered, with noise; white light of intensity 1 comes from what covers it.
    // Both halves of the samples are alike: films know halves of the radiance, but not of alpha.
    const auto sampler = [](auto x, auto y, auto i) {
        CounterRandom random(21, mix((std::uint64_t{y} << 32 | x) ^ mix(i % 4)));
        SyntheticSample s;
        s.alpha = random.uniform() < (x < 24 ? 0.9 : 0.4) ? 1.0f : 0.0f;
        s.high = s.irradiance = {s.alpha, s.alpha, s.alpha};
        s.shading = s.alpha;
        return s;
    };
    // Without block variances, which would be 0.
    const Inputs inputs =
        synthetic_inputs(48, 40, 8, sampler, EveryChannel - frame::ChannelSet{Channel::BlockVariance});
    Subject subject(entry(), inputs);
    const Planes& picture = subject.picture(inputs);
    double worst = 0.0;
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            const double light = std::clamp(picture.plane(c)[i], 0.0f, 1.0f);
            worst = std::max(worst, std::abs(light - picture.plane(3)[i]));
        }
    }
    // The light of pixel exceeds 1 in places, where alpha stays 1: its blend takes and gives back a little less of it.
    EXPECT_LE(worst, is_one_of({"pixel"}) ? 0.02 : 1e-5)
        << name() << ": radiance = alpha went in and did not come out";
}

// --- parameters

std::vector<double> probes(const Parameter& parameter) {
    if (parameter.choices.empty()) return {parameter.minimum, parameter.maximum};
    std::vector<double> all;
    for (std::size_t i = 0; i < parameter.choices.size(); ++i) all.push_back(static_cast<double>(i));
    return all;
}

// The values of the other parameters while one is tested: the defaults, and each choice of each other parameter, since
// a number may only be used with one of them.
std::vector<Values> surroundings(const Description& description) {
    std::vector<Values> all{default_values(description)};
    for (std::size_t p = 0; p < description.parameters.size(); ++p) {
        for (std::size_t choice = 0; choice < description.parameters[p].choices.size(); ++choice) {
            all.push_back(all.front());
            all.back()[p] = static_cast<double>(choice);
        }
    }
    return all;
}

TEST_P(FilterContract, EveryParameterIsSafeOverItsRange) {
    const std::vector<Inputs> pictures{room_inputs(20, 15, 4), room_inputs(3, 2, 1)};
    const Description& description = entry().description;
    for (std::size_t p = 0; p < description.parameters.size(); ++p) {
        for (const double value : probes(description.parameters[p])) {
            for (const Inputs& inputs : pictures) {
                Subject subject(entry(), inputs);
                subject.values[p] = value;
                EXPECT_EQ(first_not_finite(subject.picture(inputs)), "")
                    << name() << ": " << description.parameters[p].name << " = " << value;
            }
        }
    }
}

// A session of four pictures: a film, the same with more samples, a moved camera, changed lights.
std::vector<Inputs> session() {
    std::vector<Inputs> pictures{room_inputs(36, 30, 2), room_inputs(36, 30, 5), room_inputs(36, 30, 1),
                                 room_inputs(36, 30, 1)};
    for (std::size_t i : {2, 3}) {
        pictures[i].camera.world_from_camera[3][0] += 0.03;
        pictures[i].changes.film_restarted = true;
    }
    pictures[3].changes.lights_or_materials = true;
    return pictures;
}

// The first picture with the values as they are, the others with one changed.
std::vector<float> after_a_change(const FilterEntry& entry, const std::vector<Inputs>& pictures,
                                  Values values, std::size_t parameter, double changed) {
    Subject subject(entry, pictures[0]);
    subject.values = std::move(values);
    subject.picture(pictures[0]);
    subject.values[parameter] = changed;
    std::vector<float> all;
    for (std::size_t i = 1; i < pictures.size(); ++i) {
        const std::vector<float> numbers = subject.numbers(pictures[i]);
        all.insert(all.end(), numbers.begin(), numbers.end());
    }
    return all;
}

TEST_P(FilterContract, EveryParameterIsLive) {
    const std::vector<Inputs> pictures = session();
    const Description& description = entry().description;
    for (std::size_t p = 0; p < description.parameters.size(); ++p) {
        bool seen = false;
        for (const Values& values : surroundings(description)) {
            const std::vector<float> before = after_a_change(entry(), pictures, values, p, values[p]);
            for (const double value : probes(description.parameters[p])) {
                seen = seen || after_a_change(entry(), pictures, values, p, value) != before;
                if (seen) break;
            }
            if (seen) break;
        }
        EXPECT_TRUE(seen) << name() << ": " << description.parameters[p].name
                          << " has no effect in a running session";
    }
}

INSTANTIATE_TEST_SUITE_P(Catalog, FilterContract, testing::Range<std::size_t>(0, catalog().size()),
                         filter_name);

}  // namespace
}  // namespace tessera::filter::test
