#pragma once

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "mediator/base/parallel.h"
#include "mediator/filter/filter.h"

// Helpers shared by several filters. Inner loops run over a row of one plane without branches, so that they
// vectorise.
namespace tessera::filter {

// Resizes `planes` to the frame; allocates only when the size changes.
inline void shape(Planes& planes, const Inputs& inputs, std::uint32_t components) {
    if (planes.width() != inputs.width || planes.height() != inputs.height ||
        planes.components() != components) {
        planes = Planes(inputs.width, inputs.height, components);
    }
}

// Measures the time of one pass of a report, from construction to destruction.
class PassTimer {
  public:
    PassTimer(Report& report, std::string_view name, double bytes_per_pixel)
        : report_(report), name_(name), bytes_(bytes_per_pixel) {}
    ~PassTimer() { report_.passes.push_back({name_, std::chrono::steady_clock::now() - started_, bytes_}); }
    PassTimer(const PassTimer&) = delete;
    PassTimer& operator=(const PassTimer&) = delete;

  private:
    Report& report_;
    std::string_view name_;
    double bytes_;
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

// function(y) for every row; rows are independent. False: stopped before the end.
template <class Function>
bool for_rows(RunContext& context, std::uint32_t height, const Function& function) {
    parallel_for(context.arena, height, [&](std::size_t y) {
        if (!context.stop.stop_requested()) function(static_cast<std::uint32_t>(y));
    });
    return !context.stop.stop_requested();
}

// e^x for x <= 0, without branches: 2^k times a polynomial of degree 6 on [-ln 2 / 2, ln 2 / 2]; relative
// error below 2e-7; 0 below -87.
inline float exp_negative(float x) {
    const float clamped = x < -87.0f ? -87.0f : x;
    const float k = std::nearbyint(clamped * 1.44269504f);
    const float r = (clamped - k * 0.693359375f) + k * 2.12194440e-4f;
    float p = 1.0f / 720.0f;
    p = p * r + 1.0f / 120.0f;
    p = p * r + 1.0f / 24.0f;
    p = p * r + 1.0f / 6.0f;
    p = p * r + 0.5f;
    p = p * r + 1.0f;
    p = p * r + 1.0f;
    const auto scale = std::bit_cast<float>((static_cast<std::int32_t>(k) + 127) << 23);
    return x < -87.0f ? 0.0f : p * scale;
}

inline float luminance(float r, float g, float b) {
    return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

// Means over squares of (2 radius + 1)^2 pixels, clipped at the borders (the mean is over the pixels inside).
// Running sums in double per row and column, so that the result does not drift. `scratch` and `out` get the
// shape of `in`.
void box_mean(const Planes& in, std::uint32_t radius, Planes& scratch, Planes& out, RunContext& context);

}  // namespace tessera::filter
