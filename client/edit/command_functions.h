#pragma once

#include "client/edit/dry_run.h"

// The implementations of the commands. `arguments` follow the command, their number is already checked; `end` is the
// column after the line. On failure they throw ScriptError and have changed nothing.
namespace tessera::edit {

using Arguments = std::vector<Word>;

void list_objects(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void show_object(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void find_objects(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void show_tree(DryRun& dry_run, const Arguments& arguments, std::size_t end);

void set_field(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void move_transform(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void rotate_transform(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void scale_transform(DryRun& dry_run, const Arguments& arguments, std::size_t end);

void create_object(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void attach_object(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void detach_object(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void remove_object(DryRun& dry_run, const Arguments& arguments, std::size_t end);

void load_file(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void save_file(DryRun& dry_run, const Arguments& arguments, std::size_t end);

void undo_transaction(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void redo_transaction(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void show_log(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void lock_objects(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void unlock_objects(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void show_members(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void begin_transaction(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void commit_transaction(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void roll_back(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void wait_seconds(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void close_scene(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void quit(DryRun& dry_run, const Arguments& arguments, std::size_t end);
void show_help(DryRun& dry_run, const Arguments& arguments, std::size_t end);

}  // namespace tessera::edit
