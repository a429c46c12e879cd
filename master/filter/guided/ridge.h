#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace tessera::filter {

// Symmetric positive definite systems (A + ridge I) a = b of order N for Lanes adjacent pixels, by Cholesky's
// factors L D L^T. Pivots below the ridge can only come from rounding and are raised to it.
template <std::size_t N, std::size_t Lanes>
class Ridge {
  public:
    using Row = std::array<float, Lanes>;

    // The lower triangle, to be filled: at(i, j) with j <= i. Overwritten by solve's factors.
    Row& at(std::size_t i, std::size_t j) { return lower_[i * (i + 1) / 2 + j]; }

    void factorise(float ridge) {
        for (std::size_t j = 0; j < N; ++j) {
            Row pivot = at(j, j);
            for (std::size_t x = 0; x < Lanes; ++x) pivot[x] = std::max(pivot[x], 0.0f) + ridge;
            for (std::size_t k = 0; k < j; ++k) subtract(at(j, k), scaled_[index(j, k)], pivot);
            for (std::size_t x = 0; x < Lanes; ++x) inverse_[j][x] = 1.0f / std::max(pivot[x], ridge);
            for (std::size_t i = j + 1; i < N; ++i) {
                Row value = at(i, j);
                for (std::size_t k = 0; k < j; ++k) subtract(at(j, k), scaled_[index(i, k)], value);
                scaled_[index(i, j)] = value;
                for (std::size_t x = 0; x < Lanes; ++x) at(i, j)[x] = value[x] * inverse_[j][x];
            }
        }
    }

    // b becomes a.
    void solve(std::array<Row, N>& b) {
        for (std::size_t i = 0; i < N; ++i) {
            for (std::size_t k = 0; k < i; ++k) subtract(at(i, k), b[k], b[i]);
        }
        for (std::size_t i = N; i-- > 0;) {
            for (std::size_t x = 0; x < Lanes; ++x) b[i][x] *= inverse_[i][x];
            for (std::size_t k = i + 1; k < N; ++k) subtract(at(k, i), b[k], b[i]);
        }
    }

  private:
    static std::size_t index(std::size_t i, std::size_t j) { return i * (i - 1) / 2 + j; }
    static void subtract(const Row& a, const Row& b, Row& from) {
        for (std::size_t x = 0; x < Lanes; ++x) from[x] -= a[x] * b[x];
    }

    std::array<Row, N*(N + 1) / 2> lower_;
    std::array<Row, N*(N - 1) / 2> scaled_;  // L D below the diagonal
    std::array<Row, N> inverse_;             // of the pivots
};

}  // namespace tessera::filter
