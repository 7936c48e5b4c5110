// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "apps/distributed/mpi_job.hpp"

namespace emberfold::apps {

namespace {

int number_in(const char* name) {
  const char* const text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): no other thread exists yet
  return text == nullptr ? 0 : std::atoi(text);
}

}  // namespace

int launched_ranks() {
  if (const int ranks = number_in("OMPI_COMM_WORLD_SIZE"); ranks > 0) return ranks;  // Open MPI
  const int ranks = number_in("PMI_SIZE");  // MPICH, and Slurm, which also sets it for single processes
  return ranks > 1 ? ranks : 0;
}

int launched_rank() {
  return number_in(number_in("OMPI_COMM_WORLD_SIZE") > 0 ? "OMPI_COMM_WORLD_RANK" : "PMI_RANK");
}

}  // namespace emberfold::apps
