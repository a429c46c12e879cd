#include "client/edit/interpreter.h"

#include "client/edit/commands.h"
#include "client/edit/script_error.h"

namespace tessera::edit {
namespace {

std::string trimmed(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    return std::string(line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1));
}

// Runs the script in `dry_run`; throws ScriptError with the line.
void dry_run_script(DryRun& dry_run, std::string_view text) {
    std::size_t number = 0;
    try {
        while (!text.empty() && !dry_run.has_quit()) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            const std::string_view line = text.substr(0, end);
            text.remove_prefix(std::min(end + 1, text.size()));
            dry_run.start_line(++number, trimmed(line));
            run_line(dry_run, line);
        }
        dry_run.commit();
    } catch (const ScriptError& error) {
        throw ScriptError(error.line() ? error.line() : number, error.column(), error.what());
    }
}

Error refused(const std::vector<std::string>& problems) {
    std::string text = "the master rejects it";
    for (const std::string& problem : problems) text += ": " + problem;
    return Error(ErrorCode::Refused, text);
}

// Converts exceptions to returned errors.
template <class T, class Call>
Expected<T> answer(const Call& call) {
    try {
        return call();
    } catch (const Error& error) {
        return tl::unexpected<Error>(error);
    }
}

}  // namespace

std::optional<EditInterpreter::Failure> EditInterpreter::execute(const std::vector<Step>& steps) {
    std::vector<std::uint64_t> done;
    const auto revert = [&](std::size_t line, const Error& error) {
        std::string text = error.what();
        std::size_t undone = 0;
        for (auto number = done.rbegin(); number != done.rend(); ++number, ++undone) {
            const auto reply = answer<std::string>([&] { return target_.undo(*number); });
            if (reply) continue;
            text += "; transaction " + std::to_string(*number) +
                    " before it could not be undone and remains: " + reply.error().what();
            return Failure{line, Error(error.code(), text)};
        }
        if (undone > 0) text += "; earlier transactions undone: " + std::to_string(undone);
        return Failure{line, Error(error.code(), text)};
    };
    for (const Step& step : steps) {
        if (const auto* transaction = std::get_if<Transaction>(&step)) {
            for (const scene::BlobPtr& blob : transaction->blobs) target_.add_blob(blob);
            const auto reply =
                answer<SubmitReply>([&] { return target_.submit(transaction->entries, transaction->label); });
            if (!reply) return revert(transaction->line, reply.error());
            if (!reply->accepted) return revert(transaction->line, refused(reply->problems));
            done.push_back(reply->transaction);
        } else {
            const auto& action = std::get<Action>(step);
            const auto text = answer<std::string>([&] { return action.run(target_); });
            if (!text) return revert(action.line, text.error());
            if (!text->empty()) print_(*text);
        }
    }
    return std::nullopt;
}

Expected<void> EditInterpreter::run_script(const std::string& name, std::string_view text) {
    const auto at = [&](std::size_t line, std::size_t column) {
        return name + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
    };
    try {
        target_.refresh();
        DryRun dry_run(target_, DryRun::Actions::AtCommit);
        dry_run_script(dry_run, text);
        has_quit_ |= dry_run.has_quit();
        const auto failed = execute(dry_run.take_steps());
        if (failed) return failure(failed->error.code(), at(failed->line, 1) + failed->error.what());
        return {};
    } catch (const ScriptError& error) {
        return failure(error.code(), at(error.line(), error.column()) + error.what());
    } catch (const Error& error) {
        return failure(error.code(), name + ": " + error.what());
    }
}

DryRun& EditInterpreter::prompt() {
    if (!prompt_) prompt_.emplace(target_, DryRun::Actions::Immediately);
    return *prompt_;
}

const scene::Scene& EditInterpreter::scene() {
    prompt().sync_with_target();
    return prompt().scene();
}

Expected<void> EditInterpreter::run_line(std::string_view line) {
    try {
        target_.refresh();
        DryRun& dry_run = prompt();
        dry_run.sync_with_target();
        DryRun attempt = dry_run;  // shares the objects
        attempt.start_line(1, trimmed(line));
        tessera::edit::run_line(attempt, line);
        if (!attempt.is_open()) attempt.commit();
        has_quit_ |= attempt.has_quit();
        const auto failed = execute(attempt.take_steps());
        if (failed) {
            if (!dry_run.is_open()) prompt_.reset();
            return tl::unexpected<Error>(failed->error);
        }
        prompt_.emplace(std::move(attempt));
        if (!prompt_->is_open()) prompt_.reset();
        return {};
    } catch (const ScriptError& error) {
        return failure(error.code(), "column " + std::to_string(error.column()) + ": " + error.what());
    } catch (const Error& error) {
        return tl::unexpected<Error>(error);
    }
}

}  // namespace tessera::edit
