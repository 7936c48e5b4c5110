# SPDX-License-Identifier: Apache-2.0
"""Arrays and files as clips."""
import numpy as np
import pytest

import emberfold as ef
from emberfold import _native
from scenes import ripples


def random_views(count, seed):
    """Arrays of random shape, type, order and strides."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        shape = tuple(rng.integers(1, 9, 3)) + ((3,) if rng.random() < 0.5 else ())
        steps = rng.integers(1, 4, 3) * rng.choice([-1, 1], 3)
        large = tuple(n * abs(s) for n, s in zip(shape, steps)) + shape[3:]
        dtype = rng.choice(["uint8", "uint16", "float32"])
        values = rng.random(large) if dtype == "float32" else rng.integers(0, 255, large)
        array = np.asarray(values, dtype, order=rng.choice(["C", "F"]))
        if rng.random() < 0.3:
            array = np.asarray(array.T, order="F").T
        yield array[tuple(slice(None, None, s) for s in steps)]


@pytest.mark.parametrize("seed", range(4))
def test_any_layout_is_read_as_numpy_reads_it(seed):
    for array in random_views(60, seed):
        clip = ef.open(array)
        assert clip.shape == array.shape and clip.dtype == array.dtype
        assert np.array_equal(clip._data.read(), array)


def test_an_array_is_not_copied():
    array = ripples()
    clip = ef.open(array, frames=slice(2, 30, 2), roi=(3, 4, 20, 10))
    assert np.shares_memory(np.asarray(clip), array)
    assert np.array_equal(np.asarray(clip), array[2:30:2, 4:14, 3:23])


def test_a_part_of_an_array_knows_where_it_begins():
    def origin(**part):
        return ef.open(ripples(), fps=10, **part)._data.origin
    assert origin() == (0, 0, 0, "") and origin(frames=slice(0, 9)) == (0, 0, 0, "")
    assert origin(frames=slice(5, None, 2), roi=(3, 4, 20, 10)) == (3, 4, 0.5, "source")
    assert origin(roi=(3, 4, 20, 10), origin="part") == (0, 0, 0, "part")
    inner = ef.open(ef.open(ripples(), fps=10, frames=slice(5, None)), roi=(3, 4, 20, 10))
    assert inner._data.origin == (3, 4, 0.5, "source")
    with pytest.raises(ValueError, match="origin is 'here'"):
        origin(origin="here")


def test_a_clip_becomes_an_array_as_numpy_asks():
    clip = ef.open(ripples())
    assert not np.shares_memory(np.array(clip), ripples()) and np.asarray(clip, np.float32).dtype == np.float32
    assert ef.__version__.count(".") == 2 and len(clip) == 40 and np.array_equal(clip[3:5], ripples()[3:5])


def test_white_is_that_of_the_bits_in_use():
    assert ef.open(np.full((2, 3, 4), 9, np.uint8)).white == 255
    assert ef.open(np.full((2, 3, 4), 3000, np.uint16)).white == 4095
    assert ef.open(np.full((2, 3, 4), 0.5, np.float32)).white == 1
    assert ef.open(np.full((2, 3, 4), 3000, np.uint16), white=65535).white == 65535


@pytest.mark.parametrize("array, words", [
    (np.zeros((3, 4), np.uint8), r"clip has the shape \(3, 4\)"),
    (np.zeros((3, 4, 5, 2), np.uint8), r"clip has the shape \(3, 4, 5, 2\)"),
    (np.zeros((0, 4, 5), np.uint8), "clip has the shape"),
    (np.zeros((3, 4, 5)), "clip has the dtype float64"),
    (np.zeros((3, 4, 5), np.int32), "clip has the dtype int32"),
    (np.zeros((3, 4, 5), bool), "clip has the dtype bool"),
    (np.full((3, 4, 5), np.nan, np.float32), "clip holds a value that is no finite number"),
    ([1, 2], "clip is a list"),
])
def test_what_is_no_clip_is_named(array, words):
    for function in (ef.open, ef.analyze, ef.dytex.learn, ef.quilt):
        with pytest.raises(ValueError, match=words):
            function(array)
    with pytest.raises(ValueError, match=words.replace("clip", "b", 1)):
        ef.compare(ripples(), array)


@pytest.mark.parametrize("given, words", [
    ({"fps": 0}, "fps is 0"), ({"fps": float("nan")}, "fps is nan"), ({"pixel_size": -1}, "pixel_size is -1"),
    ({"roi": (30, 0, 10, 10)}, "roi is"), ({"frames": 3}, "frames is 3"), ({"white": -2}, "white is -2"),
])
def test_arguments_out_of_range_are_named(given, words):
    with pytest.raises(ValueError, match=words):
        ef.open(ripples(), **given)


def test_files_are_read_as_arrays_are(tmp_path):
    array = ripples(colour=True)
    path = tmp_path / "clip.avi"
    ef.write_video(path, array, fps=20)
    clip = ef.open(path)
    assert clip.fps == 20 and np.array_equal(np.asarray(clip), array)
    part = ef.open(path, frames=slice(5, 25, 4), roi=(2, 3, 10, 8))
    assert part.fps == 5 and part.shape[0] == 5
    assert np.array_equal(np.asarray(part), array[5:25:4, 3:11, 2:12])
    assert np.array_equal(clip[7], array[7])


def test_errors_have_their_classes(tmp_path):
    with pytest.raises(ef.IoError) as caught:
        ef.open(tmp_path / "none.avi")
    assert isinstance(caught.value, OSError)
    with pytest.raises(ef.InputError) as caught:
        ef.dytex.learn(ripples(), components=0)
    assert isinstance(caught.value, ValueError) and "components" in str(caught.value)
    with pytest.raises(ValueError, match="LearnOptions has no field 'n'"):
        ef.dytex.learn(ripples(), n=3)
    with pytest.raises(ValueError, match="ExtractOptions.spacing is 'wide'"):
        ef.ExtractOptions(spacing="wide")
    with pytest.raises(ValueError, match="method is 'paint'; allowed is footage, edit, strokes, diffusion, texture"):
        ef.ClipSynthesisOptions(method="paint")
    assert ef.ClipSynthesisOptions(method="strokes").method.name == "strokes"
    with pytest.raises(ValueError, match="LearnOptions.order is 'best'; allowed is given, gavish_donoho, held_out"):
        ef.dytex.learn(ripples(), order="best")


def test_options_are_values_with_the_defaults_and_words_of_the_library():
    options = ef.ExtractOptions(spacing=7)
    assert options.to_dict() == {**ef.ExtractOptions().to_dict(), "spacing": 7}
    assert eval(repr(options), {"ExtractOptions": ef.ExtractOptions}) == options != ef.ExtractOptions()
    for name in ("AnalyzeOptions", "ExtractOptions", "MatchOptions", "QuiltOptions", "CompareOptions", "LearnOptions"):
        assert "Fields, with their defaults" in getattr(_native, name).__doc__
    for function in (ef.analyze, ef.compare, ef.quilt, ef.dytex.learn, ef.sketch.extract, ef.graph.match):
        assert len(function.__doc__) > 300, function
    assert "PX" in ef.ExtractOptions.spacing.__doc__
