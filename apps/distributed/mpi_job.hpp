// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "dytex/distributed/communicator.hpp"

namespace emberfold::apps {

/// Ranks of a job that mpirun has started.
class MpiJob {
 public:
  MpiJob() = default;
  virtual ~MpiJob() = default;  ///< waits for all ranks to come to their end
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;

  [[nodiscard]] virtual dytex::Communicator& ranks() = 0;
  /// Ends all ranks at once, with this status: for a failure that the others do not know of.
  [[noreturn]] virtual void abort(int status) = 0;
};

/// Returns how many ranks the launcher tells this process that there are, 0 where none started it; and which
/// of them it is.
int launched_ranks();
int launched_rank();

/// Joins the job where a launcher started this process; null where none did. A build without MPI
/// (EMBERFOLD_MPI) joins none: Misuse where there is more than one rank.
std::unique_ptr<MpiJob> join_mpi_job();
/// True where this build can join no job and rank 0 is there to tell so.
bool is_left_out();

}  // namespace emberfold::apps
