#include "client/tools/chrome_trace.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace tessera::tools {

namespace {

using Json = nlohmann::ordered_json;
constexpr int MasterRow = 1, FirstClientRow = 100, FirstNodeRow = 10'000;

std::optional<std::int64_t> first_time(const std::vector<session::EditTrace>& edits) {
    std::optional<std::int64_t> first;
    const auto look_at = [&](std::int64_t time) {
        if (time != 0) first = std::min(first.value_or(time), time);
    };
    for (const session::EditTrace& edit : edits) {
        for (const std::int64_t time : {edit.submitted, edit.received, edit.published, edit.merged})
            look_at(time);
        for (const session::NodeTrace& node : edit.nodes) {
            look_at(node.received);
            look_at(node.built);
        }
    }
    return first;
}

// Rows in the order of their first edit.
class Rows {
  public:
    explicit Rows(int first) : next_(first) {}
    int of(const std::string& name) {
        return rows_.try_emplace(name, next_).second ? next_++ : rows_.at(name);
    }
    const std::map<std::string, int>& all() const { return rows_; }

  private:
    int next_;
    std::map<std::string, int> rows_;
};

class Writer {
  public:
    explicit Writer(std::int64_t origin) : origin_(origin) {}

    // Slices of different edits overlap, which only asynchronous events may. A clock's error may put the end
    // before the beginning.
    void slice(int row, const std::string& name, std::size_t edit, std::int64_t from, std::int64_t to,
               Json arguments) {
        if (from == 0 || to == 0) return;
        const auto event = [&](const char* phase, std::int64_t at) {
            return Json{{"ph", phase}, {"cat", "edit"}, {"name", name},    {"id", edit},
                        {"pid", row},  {"tid", row},    {"ts", micros(at)}};
        };
        Json begin = event("b", from);
        begin["args"] = std::move(arguments);
        events_.push_back(std::move(begin));
        events_.push_back(event("e", std::max(from, to)));
    }
    void row(int row, const std::string& name) {
        events_.push_back({{"ph", "M"}, {"name", "process_name"}, {"pid", row}, {"args", {{"name", name}}}});
        events_.push_back(
            {{"ph", "M"}, {"name", "process_sort_index"}, {"pid", row}, {"args", {{"sort_index", row}}}});
    }
    std::string text() const {
        const Json file{{"displayTimeUnit", "ms"}, {"traceEvents", events_}};
        return file.dump(1, ' ', false, Json::error_handler_t::replace);
    }

  private:
    double micros(std::int64_t time) const {
        return (static_cast<double>(time) - static_cast<double>(origin_)) * 1e-3;
    }
    std::int64_t origin_;
    Json events_ = Json::array();
};

}  // namespace

std::string chrome_trace(const std::vector<session::EditTrace>& edits) {
    Writer writer(first_time(edits).value_or(0));
    Rows clients(FirstClientRow), nodes(FirstNodeRow);
    for (std::size_t i = 0; i < edits.size(); ++i) {
        const session::EditTrace& edit = edits[i];
        const std::string name = "transaction " + std::to_string(edit.transaction);
        const Json arguments{{"bytes", edit.edit_bytes}, {"version", edit.version.number}, {"by", edit.name}};
        Json from_client = arguments;
        from_client["clock_bound_us"] = static_cast<double>(edit.bound) * 1e-3;
        writer.slice(clients.of(edit.name), name + " to master", i, edit.submitted, edit.received,
                     from_client);
        writer.slice(MasterRow, name + " to published", i, edit.received, edit.published, arguments);
        writer.slice(MasterRow, name + " to picture", i, edit.published, edit.merged, arguments);
        for (const session::NodeTrace& node : edit.nodes) {
            Json on_node = arguments;
            on_node["clock_bound_us"] = static_cast<double>(node.bound) * 1e-3;
            const int row = nodes.of(node.name);
            writer.slice(row, name + " to node", i, edit.published, node.received, on_node);
            writer.slice(row, name + " build", i, node.received, node.built, on_node);
        }
    }
    writer.row(MasterRow, "master");
    for (const auto& [name, row] : clients.all()) writer.row(row, "client " + name);
    for (const auto& [name, row] : nodes.all()) writer.row(row, "node " + name);
    return writer.text();
}

}  // namespace tessera::tools
