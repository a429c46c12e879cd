#pragma once

#include "mediator/base/error.h"
#include "mediator/wire/journal_records.h"

namespace tessera::master {

using wire::RecordedEdit;

// Records everything that a restarted master needs, before it is acknowledged. A change that cannot be recorded is
// refused.
class EditRecorder {
  public:
    virtual ~EditRecorder() = default;
    virtual Expected<void> joined(const wire::RecordedEditor& editor) = 0;
    virtual Expected<void> edited(const RecordedEdit& edit) = 0;
    virtual void cleared() = 0;  // the scene was closed; cannot be refused
};

}  // namespace tessera::master
