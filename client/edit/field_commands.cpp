#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "client/edit/command_functions.h"
#include "client/edit/script_error.h"
#include "client/edit/values.h"
#include "mediator/scene/fields.h"

namespace tessera::edit {
namespace {

std::vector<Word> arguments_from(const Arguments& arguments, std::size_t count) {
    return {arguments.begin() + static_cast<std::ptrdiff_t>(count), arguments.end()};
}

// Applies `change` to the matrix of the transform at `path`.
template <class Change>
void change_matrix(DryRun& dry_run, const Word& path, const Change& change) {
    const ObjectId id = dry_run.read(path);
    const auto* present = dry_run.scene().find_as<scene::Transform>(id);
    if (present == nullptr) {
        throw ScriptError(path.column(),
                          dry_run.path(id) +
                              " is not a transform: change its parent, or attach it to a transform made with "
                              "'create transform'");
    }
    scene::Transform transform = *present;
    change(transform.matrix);
    using Fields = scene::Fields<scene::Transform>;
    dry_run.apply({scene::Update{id, Fields(&scene::Transform::matrix).bits(), std::move(transform)}});
}

std::vector<double> numbers(const std::vector<Word>& words) {
    std::vector<double> values;
    for (const Word& word : words) {
        for (const Word& piece : word.split(',')) values.push_back(read_number(piece));
    }
    return values;
}

}  // namespace

void set_field(DryRun& dry_run, const Arguments& arguments, std::size_t end) {
    const Word& target = arguments[0];
    const std::size_t dot = target.rfind('.');
    if (dot == Word::None) {
        throw ScriptError(
            target.column(),
            "'" + target.text() + "' does not name a field: write PATH.FIELD, as in materials/red.roughness");
    }
    const ObjectId id = dry_run.read(target.part(0, dot));
    scene::Object object = *dry_run.scene().find(id);
    const unsigned field = read_field(scene::kind(object), target.part(dot + 1));
    read_value(object, field, arguments_from(arguments, 1), end,
               [&](const Word& path) { return dry_run.read(path); });
    dry_run.apply({scene::Update{id, scene::field_bit(field), std::move(object)}});
}

void move_transform(DryRun& dry_run, const Arguments& arguments, std::size_t end) {
    const std::vector<double> by = numbers(arguments_from(arguments, 1));
    if (by.size() != 3)
        throw ScriptError(end, "'move' takes 3 numbers after the path: metres along x, y and z");
    change_matrix(dry_run, arguments[0],
                  [&](glm::dmat4& matrix) { matrix[3] += glm::dvec4(by[0], by[1], by[2], 0.0); });
}

void rotate_transform(DryRun& dry_run, const Arguments& arguments, std::size_t end) {
    const std::vector<Word> words = arguments_from(arguments, 1);
    glm::dvec3 axis(0.0);
    double degrees = 0.0;
    const std::string axes = "xyz";
    const bool is_named = words[0].text().size() == 1 && axes.find(words[0].text()[0]) != std::string::npos;
    if (is_named) {
        if (words.size() != 2) throw ScriptError(end, "'rotate PATH x' takes one number: degrees");
        axis[static_cast<glm::length_t>(axes.find(words[0].text()[0]))] = 1.0;
        degrees = read_number(words[1]);
    } else {
        const std::vector<double> values = numbers(words);
        if (values.size() != 4) {
            throw ScriptError(end,
                              "'rotate' takes an axis (x, y, z or 3 numbers) and degrees after the path");
        }
        axis = {values[0], values[1], values[2]};
        degrees = values[3];
    }
    if (!(glm::length(axis) > 0.0)) throw ScriptError(words[0].column(), "the axis must not be zero");
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), glm::radians(degrees), glm::normalize(axis));
    change_matrix(dry_run, arguments[0], [&](glm::dmat4& matrix) {
        const glm::dvec4 place = matrix[3];
        matrix = turn * matrix;
        matrix[3] = place;  // about its own origin
    });
}

void scale_transform(DryRun& dry_run, const Arguments& arguments, std::size_t end) {
    const std::vector<double> by = numbers(arguments_from(arguments, 1));
    if (by.size() != 1 && by.size() != 3) {
        throw ScriptError(end, "'scale' takes 1 number for all axes, or 3, after the path");
    }
    const glm::dvec3 factors = by.size() == 1 ? glm::dvec3(by[0]) : glm::dvec3(by[0], by[1], by[2]);
    change_matrix(dry_run, arguments[0], [&](glm::dmat4& matrix) { matrix = glm::scale(matrix, factors); });
}

}  // namespace tessera::edit
