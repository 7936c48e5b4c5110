# SPDX-License-Identifier: Apache-2.0
"""How far clips are from each other, and models from their clip."""
from __future__ import annotations

from typing import Any, Dict, Optional

import pandas as pd

from . import _native
from .clip import ClipLike, data_of
from .progress import Progress, reporter


def _table(columns: Dict[str, Dict[str, Optional[float]]]) -> pd.DataFrame:
    rows = [(key, name, unit, *(column.get(key) for column in columns.values())) for key, name, unit, _ in _native.MEASURES]
    table = pd.DataFrame(rows, columns=["measure", "name", "unit", *columns]).set_index("measure")
    table[list(columns)] = table[list(columns)].astype(float)
    return table


def _visible(columns: Dict[str, Optional[Dict[str, Any]]]) -> pd.DataFrame:
    rows = [(key, name, about, *(None if column is None else column[key] for column in columns.values()))
            for key, name, _, about in _native.VISIBLE_MEASURES]
    for key, name, about in (("moves_alike", "Moves alike", "flow, variance and difference all within 0.7 to 1.4"),
                             ("apart", "Apart", "how far from the source to the eye, 0 not at all")):
        rows.append((key, name, about, *(None if column is None else column[key] for column in columns.values())))
    return pd.DataFrame(rows, columns=["figure", "name", "about", *columns]).set_index("figure")


class Comparison:
    """Distances of a clip from another. `table`: a row a measure, beside the noise floor, that of the first one's own halves.
    `visible`: what a person sees of the second beside the first, where the first moves."""

    def __init__(self, found: Dict[str, Any]):
        self.distances, self.noise_floor = found["distances"], found["noise_floor"]
        self.psnr, self.ssim, self.no_psnr_reason = found["psnr"], found["ssim"], found["no_psnr_reason"]
        self.frames, self._visible = found["frames"], found["visible"]

    @property
    def table(self) -> pd.DataFrame:
        return _table({"distance": self.distances, "noise_floor": self.noise_floor})

    @property
    def visible(self) -> pd.DataFrame:
        return _visible({"value": self._visible})

    def __eq__(self, other: object) -> bool:
        return self.__dict__ == other.__dict__ if isinstance(other, Comparison) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Comparison({self.frames[0]} and {self.frames[1]} frames)\n{self.visible['value']}\n{self.table}"

    def _repr_html_(self) -> str:
        return self.visible._repr_html_() + self.table._repr_html_()


class ModelComparison:
    """Distances of clips drawn from a clip's models. `table`: a row a measure; `visible`: what a person sees of each;
    `predictions`: a row a model and step; `parameters`: numbers that it takes to draw from each."""

    def __init__(self, found: Dict[str, Any]):
        self.models, self.noise_floor = found["models"], found["noise_floor"]
        self.frames, self.learned_frames = found["frames"], found["learned_frames"]
        self._visible = found["visible"]
        self.parameters = pd.Series(found["parameters"], name="parameters", dtype=float)
        self.predictions = pd.DataFrame(found["predictions"], columns=["model", "step", "psnr", "ssim"])

    @property
    def table(self) -> pd.DataFrame:
        return _table({**self.models, "noise_floor": self.noise_floor})

    @property
    def visible(self) -> pd.DataFrame:
        return _visible(self._visible)

    def __repr__(self) -> str:
        return f"ModelComparison({self.learned_frames} of {self.frames} frames)\n{self.table}"

    def _repr_html_(self) -> str:
        return self.visible._repr_html_() + self.table._repr_html_()


def compare(a: ClipLike, b: ClipLike, *, progress: Progress = None, **options: Any) -> Comparison:
    """Measures the distances of clip `b` from clip `a`; other arguments are the fields of CompareOptions."""
    first = data_of(a, "a")
    with reporter(progress) as report:
        found = _native.compare(first, data_of(b, "b", first.fps), _native.CompareOptions(**options), report)
    return Comparison(found)


def compare_models(clip: ClipLike, *, seed: int = 1, progress: Progress = None, **options: Any) -> ModelComparison:
    """Learns models of a clip's first part and compares them with it; other arguments are the fields of CompareOptions."""
    with reporter(progress) as report:
        return ModelComparison(_native.compare_models(data_of(clip), _native.CompareOptions(**options), seed, report))


for _made in (compare, compare_models):
    _made.__doc__ = f"{_made.__doc__}\n\n{getattr(_native, _made.__name__).__doc__}"
