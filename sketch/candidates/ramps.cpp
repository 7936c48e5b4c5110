// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/ramps.hpp"

#include <algorithm>

namespace emberfold::sketch {

double RampSums::residual() const {
  if (n < 3) return 0;
  const double svv = vv - v * v / n, svi = vi - v * i / n, sii = ii - i * i / n;
  return std::max(0.0, svv > 1e-6 ? sii - svi * svi / svv : sii);
}

double Ramps::residual() const {
  double sum = 0;
  RampSums run;
  for (std::size_t k = 0; k < own_.size(); ++k) {
    if (others_[k] <= own_[k].n) {
      run.add(own_[k]);
      continue;
    }
    sum += run.residual();
    run = {};
  }
  return sum + run.residual();
}

}  // namespace emberfold::sketch
