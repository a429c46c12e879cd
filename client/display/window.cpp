#include "client/display/window.h"

#include <SDL.h>

#include <string>

#include "mediator/base/error.h"

namespace tessera::client_display {

namespace {

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorCode::Unavailable,
                what + ": " + SDL_GetError() + "; where there is no display, use --headless");
}

struct Video {
    Video() {
        SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
        if (SDL_Init(SDL_INIT_VIDEO) != 0) fail("no window can be opened");
    }
    ~Video() { SDL_Quit(); }
    Video(const Video&) = delete;
    Video& operator=(const Video&) = delete;
};

class Window final : public Presenter {
  public:
    Window(WindowMode mode, const display::Output& output) : width_(static_cast<int>(output.width)) {
        const int height = static_cast<int>(output.height);
        const Uint32 flags = mode == WindowMode::FullScreen ? SDL_WINDOW_FULLSCREEN_DESKTOP : 0;
        window_.reset(SDL_CreateWindow(("Tessera: " + output.name).c_str(), output.x, output.y, width_,
                                       height, flags | SDL_WINDOW_SHOWN));
        if (!window_) fail("no window can be opened");
        renderer_.reset(SDL_CreateRenderer(window_.get(), -1, SDL_RENDERER_PRESENTVSYNC));
        if (!renderer_) renderer_.reset(SDL_CreateRenderer(window_.get(), -1, SDL_RENDERER_SOFTWARE));
        if (!renderer_) fail("nothing can be drawn in the window");
        SDL_RenderSetLogicalSize(renderer_.get(), width_, height);
        texture_.reset(SDL_CreateTexture(renderer_.get(), SDL_PIXELFORMAT_RGB24, SDL_TEXTUREACCESS_STREAMING,
                                         width_, height));
        if (!texture_) fail("the picture is too large for the window's device");
        if (mode == WindowMode::FullScreen) SDL_ShowCursor(SDL_DISABLE);
        show();
    }

    void prepare(DevicePictures pictures) override {
        SDL_UpdateTexture(texture_.get(), nullptr, pictures.front().data(), 3 * width_);
    }
    void present(std::uint64_t) override { show(); }

    bool attend() override {
        for (SDL_Event event; SDL_PollEvent(&event) != 0;) {
            if (event.type == SDL_QUIT) return false;
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
        SDL_RenderCopy(renderer_.get(), texture_.get(), nullptr, nullptr);
        SDL_RenderPresent(renderer_.get());
    }
    template <auto End>
    struct Ends {
        template <class T>
        void operator()(T* thing) const {
            End(thing);
        }
    };

    int width_;
    Video video_;  // last to end
    std::unique_ptr<SDL_Window, Ends<SDL_DestroyWindow>> window_;
    std::unique_ptr<SDL_Renderer, Ends<SDL_DestroyRenderer>> renderer_;
    std::unique_ptr<SDL_Texture, Ends<SDL_DestroyTexture>> texture_;
};

}  // namespace

std::unique_ptr<Presenter> make_window(WindowMode mode, const display::Output& output) {
    if (output.stereo == display::Stereo::Separate)
        throw Error(
            ErrorCode::InvalidInput,
            "output '" + output.name + "' has two pictures: a window shows one; use --headless --png");
    return std::make_unique<Window>(mode, output);
}

}  // namespace tessera::client_display
