// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "dytex/distributed/communicator.hpp"

namespace emberfold::apps {

/// Ranks of a job that mpirun has started.
class MpiJob {
 public:
  MpiJob() = default;
  virtual ~MpiJob() = default;  ///< waits until all ranks end
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;

  [[nodiscard]] virtual dytex::Communicator& ranks() = 0;
  /// Ends all ranks at once, with this status: for a failure that the others do not notice.
  [[noreturn]] virtual void abort(int status) = 0;
};

/// Returns the number of ranks that the launcher reports to this process, 0 where none started it, and this
/// process's rank.
int launched_ranks();
int launched_rank();

/// Joins the job where a launcher started this process; null where none did.
/// A build without MPI (EMBERFOLD_MPI) joins none: Misuse where there is more than one rank.
std::unique_ptr<MpiJob> join_mpi_job();
/// Returns whether this build can join no job and another rank, 0, reports it.
bool is_left_out();

}  // namespace emberfold::apps
