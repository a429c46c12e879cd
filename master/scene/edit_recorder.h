#pragma once

#include "mediator/base/error.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

using wire::RecordedEdit;

// Told of everything that a restarted master must know again, before anybody else is. What it
// fails to keep does not happen.
class EditRecorder {
  public:
    virtual ~EditRecorder() = default;
    virtual Expected<void> joined(const wire::RecordedEditor& editor) = 0;
    virtual Expected<void> edited(const RecordedEdit& edit) = 0;
    virtual void cleared() = 0;  // the scene was closed; cannot be refused
};

}  // namespace tessera::master
