#pragma once

#include "client/job.h"
#include "mediator/wire/messages.h"

// Between what the protocol says and what a client's user sees.
namespace tessera::client {

wire::StartJob to_wire(const JobRequest& request, JobId job);
Progress from_wire(const wire::JobProgress& progress);
JobResult from_wire(const wire::JobDone& done);  // without film
ClusterStatus from_wire(const wire::StatusReply& reply);

}  // namespace tessera::client
