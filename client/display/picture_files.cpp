#include "client/display/picture_files.h"

#include "mediator/base/error.h"
#include "mediator/picture/png_writer.h"

namespace tessera::client_display {

namespace {

class PictureFiles final : public Presenter {
  public:
    PictureFiles(const std::filesystem::path& folder, const display::Output& output)
        : width_(output.width), height_(output.height) {
        const bool has_two = output.stereo == display::Stereo::Separate;
        for (const char* suffix : has_two ? std::vector{"-left.png", "-right.png"} : std::vector{".png"})
            paths_.push_back(folder / (output.name + suffix));
    }

    void prepare(DevicePictures pictures) override {
        for (std::size_t i = 0; i < paths_.size(); ++i)
            picture::write_png(next(paths_[i]), width_, height_, pictures[i]);
    }

    void present(std::uint64_t) override {
        for (const std::filesystem::path& path : paths_) {
            std::error_code failed;
            std::filesystem::rename(next(path), path, failed);
            if (failed) throw Error(ErrorCode::Io, path.string() + " cannot be written: " + failed.message());
        }
    }

  private:
    static std::string next(const std::filesystem::path& path) { return path.string() + ".next"; }

    std::uint32_t width_, height_;
    std::vector<std::filesystem::path> paths_;
};

}  // namespace

std::unique_ptr<Presenter> make_picture_files(const std::filesystem::path& folder,
                                              const display::Output& output) {
    // Names come from the master: must not point outside of the folder.
    if (output.name.find_first_of("/\\") != std::string::npos || output.name.starts_with("."))
        throw Error(
            ErrorCode::InvalidInput,
            "output '" + output.name + "' cannot be used as a file name: rename it in the display file");
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw Error(ErrorCode::Io, folder.string() + " cannot be created: " + failed.message());
    return std::make_unique<PictureFiles>(folder, output);
}

}  // namespace tessera::client_display
