#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"
#include "tests/filter/synthetic.h"

// Test pictures for every filter of the table.
namespace tessera::filter::test {

// A coherent scene with every channel: background above and a partly covered edge to it, albedo checker,
// three orientations, a step in depth with an object's edge, direct light in `low`, Bernoulli light with rare
// bright samples in `high`. No linear dependencies.
SyntheticSample room(std::uint32_t width, std::uint32_t height, std::uint32_t x, std::uint32_t y,
                     std::uint64_t sample);
Inputs room_inputs(std::uint32_t width, std::uint32_t height, std::uint64_t n);

// Returned by a sampler for a sample that put_sample must reject, so that counts differ between pixels.
SyntheticSample rejected();

// A film of one colour without noise (premultiplied alpha 1), the features and rejected samples whatever
// `features` says, but the albedo white; `high` is the irradiance times the albedo.
inline constexpr std::array<float, 3> ConstantColor{0.7f, 0.3f, 1.5f};
Inputs constant_inputs(std::uint32_t width, std::uint32_t height, std::uint64_t n, const Sampler& features);

struct MalformedCase {
    std::string name;
    Inputs inputs;
};
// Finite inputs at the limits of what a film can be.
std::vector<MalformedCase> malformed_cases();

// A filter of the table with its values, used as the master does.
class Subject {
  public:
    explicit Subject(const FilterEntry& entry, const Inputs& inputs, int threads = 2);
    // The picture (and the maps after it, when wanted) as one list of numbers.
    std::vector<float> numbers(const Inputs& inputs, bool with_maps = false);
    const Planes& picture(const Inputs& inputs);

    Values values;
    std::unique_ptr<Filter> filter;
    tbb::task_arena arena;
    Output out;
    Report report;
};

// The first difference in bits; empty if there is none.
std::string first_difference(std::span<const float> a, std::span<const float> b);
// The first number that is not finite; empty if all are.
std::string first_not_finite(const Planes& planes);

// One test per line of the catalog, by its name.
class FilterContract : public testing::TestWithParam<std::size_t> {
  protected:
    // What is optional on other machines is there in tests, if only as a stand-in.
    void SetUp() override { ASSERT_EQ(why_unavailable(entry()), ""); }
    const FilterEntry& entry() const { return catalog()[GetParam()]; }
    std::string name() const { return std::string(entry().description.name); }
    bool is_one_of(std::initializer_list<std::string_view> names) const {
        return std::ranges::find(names, entry().description.name) != names.end();
    }
};
std::string filter_name(const testing::TestParamInfo<std::size_t>& tested);

}  // namespace tessera::filter::test
