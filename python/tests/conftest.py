# SPDX-License-Identifier: Apache-2.0
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
import emberfold as ef  # noqa: E402
from scenes import bars  # noqa: E402


@pytest.fixture(scope="session")
def run():
    """One analysis for the tests that change nothing of it."""
    return ef.analyze(ef.open(bars(), fps=30, pixel_size=0.065))
