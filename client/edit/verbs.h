#pragma once

#include "client/edit/rehearsal.h"

// What the commands do. `arguments` are those behind the command, in the number that it takes; `end` is the
// column behind the line. They throw ScriptError, and then have changed nothing.
namespace tessera::edit {

using Arguments = std::vector<Word>;

void list_objects(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void show_object(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void find_objects(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void show_tree(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);

void set_field(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void move_transform(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void rotate_transform(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void scale_transform(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);

void create_object(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void attach_object(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void detach_object(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void remove_object(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);

void load_file(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void save_file(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);

void undo_transaction(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void redo_transaction(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void show_log(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void lock_objects(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void unlock_objects(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void show_people(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void begin_transaction(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void commit_transaction(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void roll_back(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void wait_seconds(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void close_scene(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void quit(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);
void show_help(Rehearsal& rehearsal, const Arguments& arguments, std::size_t end);

}  // namespace tessera::edit
