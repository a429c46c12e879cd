#pragma once

#include <cfenv>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace tessera::test {

// Rounds upwards in this thread and, where the processor can, flushes subnormal numbers, as after -ffast-math.
class UnusualFloatMode {
  public:
    UnusualFloatMode() {
        std::fegetenv(&before_);
        std::fesetround(FE_UPWARD);
#if defined(__SSE__)
        constexpr unsigned FlushResults = 0x8000, ZeroArguments = 0x0040;
        _mm_setcsr(_mm_getcsr() | FlushResults | ZeroArguments);
#endif
    }
    ~UnusualFloatMode() {
        std::fesetenv(&before_);
    }
    UnusualFloatMode(const UnusualFloatMode&) = delete;
    UnusualFloatMode& operator=(const UnusualFloatMode&) = delete;

  private:
    std::fenv_t before_;
};

inline bool has_standard_float_mode() {
    const volatile float one = 1.0f, little = 0x1p-25f, smallest = 0x1p-126f, half = 0.5f;
    const volatile float subnormal = smallest * half;
    return one + little == 1.0f && subnormal > 0.0f && subnormal + subnormal == smallest;
}

}  // namespace tessera::test
