#include "client/display_file/mesh_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <glm/vec2.hpp>
#include <limits>

#include "client/display_file/file_bytes.h"
#include "mediator/display/bilinear_patch.h"

namespace tessera::display_file {

namespace {

constexpr std::size_t MostNodes = 4096;  // a side
constexpr float Nothing = std::numeric_limits<float>::quiet_NaN();

struct Node {
    glm::dvec2 at{0.0};  // pixels of the picture
    glm::dvec2 source{0.0};
    double brightness = 1.0;
    bool is_shown() const {
        return brightness >= 0.0 && source.x >= 0.0 && source.x <= 1.0 && source.y >= 0.0 && source.y <= 1.0;
    }
};

// Reads line by line, skipping empty lines.
class Lines {
  public:
    explicit Lines(std::string_view text) : rest_(text) {}
    std::size_t number() const { return number_; }
    bool is_at_end() {
        while (!rest_.empty() && (rest_.front() == '\n' || rest_.front() == '\r' || rest_.front() == ' ' ||
                                  rest_.front() == '\t')) {
            number_ += rest_.front() == '\n';
            rest_.remove_prefix(1);
        }
        return rest_.empty();
    }
    // `count` finite numbers and nothing else on the next line.
    template <std::size_t Count>
    bool read(std::array<double, Count>& numbers) {
        if (is_at_end()) return false;
        std::string_view line = rest_.substr(0, rest_.find('\n'));
        rest_.remove_prefix(line.size());
        for (double& number : numbers) {
            while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
            const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
            if (error != std::errc{} || !std::isfinite(number)) return false;
            line.remove_prefix(std::size_t(end - line.data()));
        }
        return line.find_first_not_of(" \t\r") == std::string_view::npos;
    }

  private:
    std::string_view rest_;
    std::size_t number_ = 1;
};

bool is_count(double number) {
    return number >= 2.0 && number <= double(MostNodes) && number == std::floor(number);
}

void draw(const std::array<Node, 4>& nodes, std::uint32_t width, std::uint32_t height, LoadedMesh& mesh) {
    for (const Node& node : nodes)
        if (!node.is_shown()) return;
    const display::BilinearPatch patch{{nodes[0].at, nodes[1].at, nodes[2].at, nodes[3].at}};
    patch.for_each_pixel(width, height, [&](std::size_t x, std::size_t y, const glm::dvec2& uv) {
        const auto mixed = [&](const auto& of) {
            return (1 - uv.y) * ((1 - uv.x) * of(nodes[0]) + uv.x * of(nodes[1])) +
                   uv.y * ((1 - uv.x) * of(nodes[2]) + uv.x * of(nodes[3]));
        };
        const std::size_t pixel = y * width + x;
        mesh.source_uv.values[2 * pixel] =
            static_cast<float>(mixed([](const Node& n) { return n.source.x; }));
        mesh.source_uv.values[2 * pixel + 1] =
            static_cast<float>(1.0 - mixed([](const Node& n) { return n.source.y; }));
        mesh.weights.values[pixel] =
            static_cast<float>(std::min(mixed([](const Node& n) { return n.brightness; }), 1.0));
    });
}

}  // namespace

Expected<LoadedMesh> parse_mesh(std::string_view text, const std::string& name, std::uint32_t width,
                                std::uint32_t height) {
    Lines lines(text);
    const auto refuse = [&](const std::string& why) {
        return failure(ErrorCode::InvalidInput, name + ":" + std::to_string(lines.number()) + ": " + why);
    };
    std::array<double, 1> kind{};
    if (!lines.read(kind)) return refuse("the first line must be the type of the mesh: 2, for example");
    std::array<double, 2> counts{};
    if (!lines.read(counts) || !is_count(counts[0]) || !is_count(counts[1]))
        return refuse("the second line must be the columns and rows of nodes, 2 to " +
                      std::to_string(MostNodes));
    const auto columns = std::size_t(counts[0]), rows = std::size_t(counts[1]);
    // A node takes at least ten bytes: rejects counts that exceed the text before allocating memory.
    if (columns * rows > text.size() / 9) return refuse("states more nodes than it has lines");
    const double aspect = double(width) / height;
    std::vector<Node> nodes(columns * rows);
    for (Node& node : nodes) {
        std::array<double, 5> n{};
        if (!lines.read(n)) return refuse("a node must be five numbers: x y u v brightness");
        node = {{(n[0] / aspect + 1.0) / 2.0 * width, (1.0 - n[1]) / 2.0 * height}, {n[2], n[3]}, n[4]};
    }
    if (!lines.is_at_end()) return refuse("has more lines than columns x rows");

    LoadedMesh mesh{{width, height, 2, std::vector<float>(std::size_t{2} * width * height, Nothing)},
                    {width, height, 1, std::vector<float>(std::size_t{width} * height, 0.0f)}};
    for (std::size_t row = 0; row + 1 < rows; ++row)
        for (std::size_t column = 0; column + 1 < columns; ++column) {
            const Node* corner = nodes.data() + row * columns + column;
            draw({corner[0], corner[1], corner[columns], corner[columns + 1]}, width, height, mesh);
        }
    return mesh;
}

Expected<LoadedMesh> load_mesh(const std::string& path, std::uint32_t width, std::uint32_t height) {
    constexpr std::size_t MostBytes = 64 << 20;
    const auto bytes = read_file(path, MostBytes);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_mesh({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path, width, height);
}

}  // namespace tessera::display_file
