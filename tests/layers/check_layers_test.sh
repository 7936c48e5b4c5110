#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs scripts/check-layers on the repository, then on a copy with one offence of each kind.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd -P)
check="$root/scripts/check-layers"
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT

"$check"
echo "the repository: no offence"

(cd "$root" && find core graph sketch mcmc dytex pipeline apps tests -name '*.[ch]pp' -print0 |
  xargs -0 cp --parents -t "$copy")
"$check" "$copy"

# expect_failure <words that the message must hold>
expect_failure() {
  if message=$("$check" "$copy" 2>&1); then
    echo "not noticed: $1" >&2
    exit 1
  elif [[ $message != *"$1"* ]]; then
    echo "expected: $1" >&2
    echo "got:      $message" >&2
    exit 1
  fi
  echo "noticed: $1"
}

# offend <file> <included header> <arrow>: the second line of a made file is against the arrows.
offend() {
  printf '#pragma once\n#include %s\n' "$2" > "$copy/$1"
  expect_failure "$1:2: $3"
  rm "$copy/$1"
}

mkdir -p "$copy/python"
offend core/made.hpp '"core/io/mask_file.hpp"' 'core -> core/io'
offend core/math/made.hpp '"graph/patch.hpp"' 'core -> graph'
offend core/io/made.hpp '"pipeline/analyze.hpp"' 'core/io -> pipeline'
offend graph/made.cpp '"sketch/extract.hpp"' 'graph -> sketch'
offend graph/io/made.cpp '<core/io/mask_file.hpp>' 'graph -> core/io'
offend sketch/detection/made.cpp '"mcmc/model/motion_model.hpp"' 'sketch -> mcmc'
offend mcmc/made.hpp '"sketch/extract.hpp"' 'mcmc -> sketch'
offend mcmc/made.hpp '"dytex/learn.hpp"' 'mcmc -> dytex'
offend dytex/made.hpp '"graph/patch.hpp"' 'dytex -> graph'
offend pipeline/made.cpp '"apps/cli/command.hpp"' 'pipeline -> apps'
offend python/made.cpp '"apps/cli/command.hpp"' 'python -> apps'
offend apps/cli/made.cpp '"tests/support/catch.hpp"' 'apps -> tests'
offend graph/made.cpp '"../sketch/extract.hpp"' '"../sketch/extract.hpp" is relative'
offend tests/graph/made_test.cpp '"apps/cli/command.hpp"' 'tests -> apps'
offend tests/support/made.hpp '"apps/cli/command.hpp"' 'tests -> apps'

printf '#include "apps/cli/command.hpp"\n' > "$copy/tests/bench/made.cpp"
"$check" "$copy"
echo "a benchmark may include apps"

printf 'namespace emberfold::graph {\nstruct Patch {\n' > "$copy/graph/made.hpp"
expect_failure 'emberfold::graph::Patch is defined in graph/'
printf 'namespace emberfold::mcmc {\nstruct Patch {\n' > "$copy/graph/made.hpp"
"$check" "$copy"
echo "a name may be used again in another namespace"
rm "$copy/graph/made.hpp"

mkdir "$copy/graph/made"
for ((k = 1; k <= 40; ++k)); do : > "$copy/graph/made/file_$k.cpp"; done
"$check" "$copy"
: > "$copy/graph/made/file_41.hpp"
expect_failure 'graph/made: 41 C++ files; allowed are 40'
