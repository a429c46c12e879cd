#include "client/display/shared_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "mediator/base/error.h"

namespace tessera::client_display {

namespace {

// While one is written, two remain intact: the presented one, and the previous one for slow readers.
constexpr std::size_t Buffers = std::tuple_size_v<decltype(SharedHeader::frames)>;

class SharedMemory final : public Presenter {
  public:
    SharedMemory(const std::string& name, const display::Output& output)
        : name_(name),
          picture_bytes_(std::size_t{3} * output.width * output.height),
          picture_count_(output.stereo == display::Stereo::Separate ? 2 : 1),
          byte_size_(sizeof(SharedHeader) + Buffers * picture_count_ * picture_bytes_) {
        ::shm_unlink(name.c_str());  // left by a killed process
        const int file = ::shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
        if (file < 0) fail("cannot be created");
        void* place = MAP_FAILED;
        if (::ftruncate(file, static_cast<off_t>(byte_size_)) == 0)
            place = ::mmap(nullptr, byte_size_, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        ::close(file);
        if (place == MAP_FAILED) {
            ::shm_unlink(name.c_str());
            fail("cannot be resized");
        }
        header_ = new (place) SharedHeader{.width = output.width,
                                           .height = output.height,
                                           .picture_count = static_cast<std::uint32_t>(picture_count_)};
        pictures_ = static_cast<std::uint8_t*>(place) + sizeof(SharedHeader);
    }
    ~SharedMemory() override {
        ::munmap(header_, byte_size_);
        ::shm_unlink(name_.c_str());
    }
    SharedMemory(const SharedMemory&) = delete;
    SharedMemory& operator=(const SharedMemory&) = delete;

    void prepare(DevicePictures pictures) override {
        std::uint8_t* const buffer = pictures_ + (next() % Buffers) * picture_count_ * picture_bytes_;
        for (std::size_t i = 0; i < picture_count_; ++i)
            std::memcpy(buffer + i * picture_bytes_, pictures[i].data(), picture_bytes_);
    }
    void present(std::uint64_t frame) override {
        header_->frames[next() % Buffers] = frame;
        header_->sequence.store(next(), std::memory_order_release);
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::Io, "shared memory " + name_ + " " + what + ": " + std::strerror(errno));
    }
    std::uint64_t next() const { return header_->sequence.load(std::memory_order_relaxed) + 1; }

    std::string name_;
    std::size_t picture_bytes_, picture_count_, byte_size_;
    SharedHeader* header_ = nullptr;
    std::uint8_t* pictures_ = nullptr;
};

}  // namespace

std::unique_ptr<Presenter> make_shared_memory(const std::string& name, const display::Output& output) {
    return std::make_unique<SharedMemory>(name, output);
}

}  // namespace tessera::client_display
