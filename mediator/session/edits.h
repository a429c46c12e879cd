#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "mediator/base/description.h"
#include "mediator/base/ids.h"

// What became of edits, who made them and how long they took, and what a picture shows at a pixel.
namespace tessera::session {

struct EditResult {
    bool accepted = false;
    Version version;                    // that holds it, or will when it is published
    std::vector<std::string> problems;  // why not
    std::uint64_t transaction = 0;      // the transaction it belongs to
    std::vector<std::string> notes;     // of an undo: fields that stay since later edits changed them
    static constexpr auto describe(auto row) {
        using Self = EditResult;
        return std::tuple(row(1, "accepted", &Self::accepted), row(2, "version", &Self::version),
                          row(3, "problems", &Self::problems), row(4, "transaction", &Self::transaction),
                          row(5, "notes", &Self::notes));
    }
};

struct TransactionSummary {
    std::uint64_t number = 0;
    std::string name, user;
    std::int64_t time = 0;    // ns since 1970
    std::uint32_t edits = 0;  // in one edit group
    std::string text;         // readable summary
    std::uint64_t undoes = 0, undone_by = 0;
    static constexpr auto describe(auto row) {
        using Self = TransactionSummary;
        return std::tuple(row(1, "number", &Self::number), row(2, "name", &Self::name),
                          row(3, "user", &Self::user), row(4, "time", &Self::time),
                          row(5, "edits", &Self::edits), row(6, "text", &Self::text),
                          row(7, "undoes", &Self::undoes), row(8, "undone_by", &Self::undone_by));
    }
};
struct FieldWriter {
    std::uint32_t field = 0;
    std::uint64_t transaction = 0;
    std::string name, user;
    std::int64_t time = 0;  // ns since 1970
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "field", &FieldWriter::field),
                          row(2, "transaction", &FieldWriter::transaction),
                          row(3, "name", &FieldWriter::name), row(4, "user", &FieldWriter::user),
                          row(5, "time", &FieldWriter::time));
    }
};

// The surface at the center of a pixel.
struct PickResult {
    Version version;
    bool hit = false;
    ObjectId object;           // the Geometry
    glm::dvec3 position{0.0};  // world
    glm::vec3 normal{0.0f};    // shading normal, world
    double distance = 0;       // from the eye
    std::string name;          // of the Geometry
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "version", &PickResult::version), row(2, "hit", &PickResult::hit),
                          row(3, "object", &PickResult::object), row(4, "position", &PickResult::position),
                          row(5, "normal", &PickResult::normal), row(6, "distance", &PickResult::distance),
                          row(7, "name", &PickResult::name));
    }
};

// Latencies of the latest edits. Times in ns of the master's clock, 0 = unknown (yet).
struct NodeTrace {
    std::string name;
    std::int64_t received = 0, built = 0;
    std::int64_t bound = 0;  // of its clock's offset
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &NodeTrace::name), row(2, "received", &NodeTrace::received),
                          row(3, "built", &NodeTrace::built), row(4, "bound", &NodeTrace::bound));
    }
};
struct EditTrace {
    std::uint64_t transaction = 0;
    std::string name;  // who
    std::uint64_t edit_bytes = 0;
    std::int64_t submitted = 0, bound = 0;  // bound: of the client's clock's offset
    std::int64_t received = 0, published = 0;
    std::vector<NodeTrace> nodes;
    std::int64_t merged = 0;  // when the first picture of its version was merged
    Version version;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "transaction", &EditTrace::transaction), row(2, "name", &EditTrace::name),
                          row(3, "edit_bytes", &EditTrace::edit_bytes),
                          row(4, "submitted", &EditTrace::submitted), row(5, "bound", &EditTrace::bound),
                          row(6, "received", &EditTrace::received),
                          row(7, "published", &EditTrace::published), row(8, "nodes", &EditTrace::nodes),
                          row(9, "merged", &EditTrace::merged), row(10, "version", &EditTrace::version));
    }
};

}  // namespace tessera::session
