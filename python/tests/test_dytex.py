# SPDX-License-Identifier: Apache-2.0
import pickle

import numpy as np
import pytest

import emberfold as ef
from scenes import ripples


@pytest.mark.parametrize("colour", [False, True])
def test_learn_edit_synthesize(colour):
    clip = ripples(colour=colour)
    texture = ef.dytex.learn(clip, components=6)
    assert texture.C.shape == (clip[0].size, 6) and not texture.C.flags.writeable
    new = texture.edit(speed=0.5).synthesize(20, seed=3)
    assert new.shape == (20,) + clip.shape[1:] and new.dtype == np.uint8
    assert np.array_equal(new, texture.edit(speed=0.5).synthesize(20, seed=3))
    assert not np.array_equal(new, texture.synthesize(20, seed=3))


def test_colours_keep_their_places():
    clip = ripples(colour=True)
    new = ef.dytex.learn(clip, components=8).synthesize(60)
    assert np.allclose(new.mean((0, 1, 2)), clip.mean((0, 1, 2)), atol=12)


def test_the_components_are_numpys():
    clip = ripples()
    texture = ef.dytex.learn(clip, components=4)
    frames = clip.reshape(len(clip), -1).astype(float)
    singular = np.linalg.svd(frames - frames.mean(0), compute_uv=False)
    assert np.allclose(texture.singular[:8], singular[:8], rtol=1e-4)
    assert np.allclose(texture.mean, frames.mean(0), atol=1e-3)


def test_a_texture_is_a_value():
    texture = ef.dytex.learn(ripples(), components=5)
    again = pickle.loads(pickle.dumps(texture))
    assert np.array_equal(again.synthesize(9), texture.synthesize(9)) and np.array_equal(again.A, texture.A)


def test_edits_are_named():
    texture = ef.dytex.learn(ripples(), components=5)
    with pytest.raises(ValueError, match="speed"):
        texture.edit(speed=9)
    with pytest.raises(ValueError, match="no argument 'pace'"):
        texture.edit(pace=2)
    assert ef.dytex.PRESETS and texture.edit(preset=ef.dytex.PRESETS[0][0]) is not texture


def test_a_folder_holds_a_texture(tmp_path):
    texture = ef.dytex.learn(ripples(), components=5)
    texture.write(str(tmp_path / "model"))
    assert np.array_equal(ef.dytex.LinearDynamicTexture.read(str(tmp_path / "model")).C, texture.C)


def test_quilts_copy_pixels_of_their_source():
    clip = ripples(frames=6, height=40, width=40)
    new, places = ef.quilt(clip, size=(70, 50), block=(16, 16), overlap=4, return_map=True)
    assert new.shape == (6, 50, 70) and places.shape == (50, 70, 3)
    assert np.array_equal(new, clip[:, places[..., 2], places[..., 1]])
    assert np.array_equal(ef.render_quilt(places, clip), new)
    deep = (clip.astype(np.uint16) << 4)[..., ::-1]
    assert ef.quilt(deep, size=(70, 50), block=(16, 16), overlap=4).dtype == np.uint16


def test_comparisons():
    clip = ripples(frames=32)
    same = ef.compare(clip, clip, strokes=False)
    assert (same.table["distance"].dropna() == 0).all() and same.psnr == 100
    other = ef.compare(clip, ef.dytex.learn(clip, components=6).synthesize(32), strokes=False)
    assert (other.table["distance"].dropna() > 0).any() and len(other.table) == len(same.table)
    models = ef.compare_models(clip, hybrid=False, star=False, strokes=False)
    assert "noise_floor" in models.table and len(models.predictions)
