#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace tessera {

// Rounding to nearest and subnormal numbers in this thread, for the lifetime of the object. Threads inherit their mode from
// the thread that starts them, and libraries that are linked with -ffast-math flush subnormal numbers in the whole program;
// samples and films would have other bits there.
class StandardFloatMode {
  public:
#if defined(__SSE__)
    // Unlike std::fesetenv, which takes hundreds of cycles, fast enough for every row of a picture.
    StandardFloatMode() : before_(_mm_getcsr()) {
        if (before_ != standard()) _mm_setcsr(standard());
    }
    ~StandardFloatMode() {
        if (before_ != standard()) _mm_setcsr(before_);
    }
#else
    StandardFloatMode() {
        std::fegetenv(&before_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~StandardFloatMode() {
        std::fesetenv(&before_);
    }
#endif
    StandardFloatMode(const StandardFloatMode&) = delete;
    StandardFloatMode& operator=(const StandardFloatMode&) = delete;

  private:
#if defined(__SSE__)
    // As before, but for the rounding (0x6000), flushing results (0x8000) and taking subnormal arguments for 0 (0x0040).
    unsigned standard() const {
        return before_ & ~0xe040u;
    }
    unsigned before_;
#else
    std::fenv_t before_;
#endif
};

}  // namespace tessera
