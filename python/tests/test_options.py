# SPDX-License-Identifier: Apache-2.0
import emberfold as ef


def test_every_field_of_the_options_is_there():
    """What the headers document of a struct of options, the class in Python has, but for what only C++ can use."""
    from emberfold._docs import TEXTS

    only_in_cpp = {"AnalyzeOptions": {"keep_sketch"}, "ClipSynthesisOptions": {"edit"},  # model.edit() in Python
                   "CompareOptions": {"in_full"}}
    rooms = {"AnalyzeOptions": "pipeline", "CompareOptions": "pipeline", "ClipSynthesisOptions": "pipeline",
             "QuiltOptions": "dytex"}
    for name, room in rooms.items():
        told = {text.rsplit("::", 1)[1] for text in TEXTS if text.startswith(f"{room}::{name}::")}
        missing = told - set(getattr(ef, name).FIELDS) - only_in_cpp.get(name, set()) - {"validate"}
        assert told and not missing, (name, missing)
    # The fields of these are taken from the structs' own tables.
    for name in ("ExtractOptions", "MatchOptions"):
        assert getattr(ef, name).FIELDS, name
        for field in getattr(ef, name).FIELDS:
            assert getattr(getattr(ef, name), field).__doc__, (name, field)
    for name in ("LearnOptions", "SynthesisOptions", "EmOptions", "CurveOptions"):
        told = {text.rsplit("::", 1)[1] for text in TEXTS if text.startswith(f"dytex::{name}::")} - {"validate"}
        assert not told - set(getattr(ef.dytex, name).FIELDS), name
