// SPDX-License-Identifier: Apache-2.0
// Stands for mpi_job.cpp in a build without MPI.
#include <string>

#include "apps/cli/command.hpp"
#include "apps/distributed/mpi_job.hpp"

namespace emberfold::apps {

std::unique_ptr<MpiJob> join_mpi_job() {
  const int ranks = launched_ranks();
  if (ranks > 1)
    throw Misuse("it was started as one of " + std::to_string(ranks) +
                 " ranks, but this build has no MPI; build it with -DEMBERFOLD_MPI=ON");
  return nullptr;
}

bool is_left_out() {
  return launched_ranks() > 1 && launched_rank() > 0;
}

}  // namespace emberfold::apps
