#include "client/display/window.h"

#include <SDL.h>

#include <string>

#include "mediator/base/error.h"

namespace tessera::client_display {

namespace {

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorCode::Unavailable,
                what + ": " + SDL_GetError() + "; use --headless if there is no display");
}

struct Video {
    Video() {
        SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
        if (SDL_Init(SDL_INIT_VIDEO) != 0) fail("no window can be opened");
        // SDL's fallback drivers without a display: invisible.
        const std::string driver = SDL_GetCurrentVideoDriver();
        if (driver == "offscreen" || driver == "dummy") {
            SDL_Quit();
            SDL_SetError("there is only SDL's driver '%s'", driver.c_str());
            fail("no window can be opened");
        }
    }
    ~Video() { SDL_Quit(); }
    Video(const Video&) = delete;
    Video& operator=(const Video&) = delete;
};

class Window final : public Presenter {
  public:
    Window(std::shared_ptr<Video> video, WindowMode mode, const display::Output& output)
        : width_(static_cast<int>(output.width)), video_(std::move(video)) {
        const int height = static_cast<int>(output.height);
        const Uint32 flags = mode == WindowMode::FullScreen ? SDL_WINDOW_FULLSCREEN_DESKTOP : 0;
        window_.reset(SDL_CreateWindow(("Tessera: " + output.name).c_str(), output.x, output.y, width_,
                                       height, flags | SDL_WINDOW_SHOWN));
        if (!window_) fail("no window can be opened");
        renderer_.reset(SDL_CreateRenderer(window_.get(), -1, SDL_RENDERER_PRESENTVSYNC));
        if (!renderer_) renderer_.reset(SDL_CreateRenderer(window_.get(), -1, SDL_RENDERER_SOFTWARE));
        if (!renderer_) fail("the window's renderer cannot be created");
        SDL_RenderSetLogicalSize(renderer_.get(), width_, height);
        for (Texture* texture : {&shown_, &next_}) {
            texture->reset(SDL_CreateTexture(renderer_.get(), SDL_PIXELFORMAT_RGB24,
                                             SDL_TEXTUREACCESS_STREAMING, width_, height));
            if (!*texture) fail("the picture is too large for the GPU");
        }
        if (mode == WindowMode::FullScreen) SDL_ShowCursor(SDL_DISABLE);
        show();
    }

    void prepare(DevicePictures pictures) override {
        SDL_UpdateTexture(next_.get(), nullptr, pictures.front().data(), 3 * width_);
    }
    void present(std::uint64_t) override {
        std::swap(shown_, next_);
        has_picture_ = true;
        show();
    }

    bool attend() override {
        for (SDL_Event event; SDL_PollEvent(&event) != 0;) {
            if (event.type == SDL_QUIT) return false;
            // The window was covered: draws again, since the next frame may be far away.
            if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_EXPOSED) show();
            if (event.type == SDL_KEYDOWN &&
                (event.key.keysym.sym == SDLK_ESCAPE || event.key.keysym.sym == SDLK_q))
                return false;
        }
        return true;
    }
    int attention_milliseconds() const override { return 20; }

  private:
    void show() {
        SDL_RenderClear(renderer_.get());
        if (has_picture_) SDL_RenderCopy(renderer_.get(), shown_.get(), nullptr, nullptr);
        SDL_RenderPresent(renderer_.get());
    }
    template <auto End>
    struct Ends {
        template <class T>
        void operator()(T* thing) const {
            End(thing);
        }
    };

    using Texture = std::unique_ptr<SDL_Texture, Ends<SDL_DestroyTexture>>;

    int width_;
    bool has_picture_ = false;
    std::shared_ptr<Video> video_;  // destroyed last
    std::unique_ptr<SDL_Window, Ends<SDL_DestroyWindow>> window_;
    std::unique_ptr<SDL_Renderer, Ends<SDL_DestroyRenderer>> renderer_;
    Texture shown_, next_;
};

}  // namespace

MakePresenter make_windows(WindowMode mode) {
    return [mode, video = std::make_shared<Video>()](const display::Output& output) {
        if (output.stereo == display::Stereo::Separate)
            throw Error(
                ErrorCode::InvalidInput,
                "output '" + output.name + "' has two pictures: a window shows one; use --headless --png");
        return std::make_unique<Window>(video, mode, output);
    };
}

}  // namespace tessera::client_display
