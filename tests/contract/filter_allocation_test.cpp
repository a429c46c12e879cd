// A filter that runs again on the same frame takes no memory: operator new is counted for the whole program.
#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/contract/filter_cases.h"

namespace {

constexpr std::size_t Noted = 1024;  // a report's few lines may be made anew, rows and planes may not
std::atomic<std::size_t> noted_bytes{0};

void* take(std::size_t bytes, std::size_t alignment) {
    if (bytes >= Noted) noted_bytes += bytes;
    void* memory = std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
    return take(bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return take(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace tessera::filter::test {
namespace {

class FilterAllocation : public FilterContract {};

TEST_P(FilterAllocation, NoneInALaterRunOfTheSameSize) {
    const Inputs inputs = room_inputs(300, 260, 2);
    Subject subject(entry(), inputs);
    for (int run = 0; run < 3; ++run) subject.picture(inputs);  // both halves of a history have been used
    noted_bytes = 0;
    subject.picture(inputs);
    EXPECT_EQ(noted_bytes, 0u) << name() << " allocates in its fourth run on one frame";
}

TEST(FilterAllocationCount, SeesAVector) {
    noted_bytes = 0;
    const std::vector<float> row(1000);
    EXPECT_GE(noted_bytes, row.size() * sizeof(float));
}

INSTANTIATE_TEST_SUITE_P(Catalog, FilterAllocation, testing::Range<std::size_t>(0, catalog().size()),
                         filter_name);

}  // namespace
}  // namespace tessera::filter::test
