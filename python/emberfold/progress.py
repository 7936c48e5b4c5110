# SPDX-License-Identifier: Apache-2.0
"""Progress of long calls."""
from __future__ import annotations

import contextlib
import sys
from typing import Callable, Iterator, Optional, Union

Report = Callable[[str, float], None]
Progress = Union[None, bool, Report]


@contextlib.contextmanager
def reporter(progress: Progress) -> Iterator[Optional[Report]]:
    """What a call reports to: nothing, a function of stage and share, or, for True, a line on standard error."""
    if not progress:
        yield None
    elif callable(progress):
        yield progress
    else:
        try:
            yield lambda stage, share: print(f"\r{stage:<12} {share:4.0%}\x1b[K", end="", file=sys.stderr, flush=True)
        finally:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
