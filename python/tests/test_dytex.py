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
    same = ef.compare(clip, clip)
    assert (same.table["distance"].dropna() == 0).all() and same.psnr == 100
    other = ef.compare(clip, ef.dytex.learn(clip, components=6).synthesize(32))
    assert (other.table["distance"].dropna() > 0).any() and len(other.table) == len(same.table)
    models = ef.compare_models(clip)
    assert "noise_floor" in models.table and len(models.predictions)


def test_comparisons_tell_what_a_person_sees():
    clip = ripples(frames=32)
    visible = ef.compare(clip, clip).visible
    assert list(visible.index) == ["complete", "coherent", "flow", "variance", "difference", "copied", "moves_alike", "apart"]
    assert visible.loc["copied", "value"] == 1 and bool(visible.loc["moves_alike", "value"])
    still = np.repeat(clip[:1], 32, axis=0)
    frozen = ef.compare(clip, still).visible["value"]
    assert frozen["variance"] == 0 and frozen["difference"] == 0 and not frozen["moves_alike"]
    models = ef.compare_models(clip)
    assert {"copied", "moves_alike"} <= set(models.visible.index) and set(models.parameters.index) <= set(models.visible)
    assert (models.parameters > 0).all()


def test_em_raises_the_likelihood_and_fills_what_is_hidden():
    clip = ripples(frames=30)
    start = ef.dytex.learn(clip, components=4)
    found = ef.dytex.maximise_likelihood(clip, start, iterations=5)
    assert (np.diff(found["log_likelihood"]) >= 0).all() and len(found["log_likelihood"]) > 1
    hidden = np.zeros(clip.shape, bool)
    hidden[10:13, 4:9, 4:9] = True
    spoilt = np.where(hidden, 0, clip).astype(np.uint8)
    texture = ef.dytex.learn_missing(spoilt, hidden, components=4, em=ef.dytex.EmOptions(iterations=20))["texture"]
    filled = texture.draw(texture.states[:, 11])
    inside = hidden[11]
    assert np.abs(filled[inside] - clip[11][inside]).mean() < 10 < np.abs(spoilt[11][inside].astype(float) - clip[11][inside]).mean()
    with pytest.raises(ValueError, match="missing has the dtype"):
        ef.dytex.learn_missing(clip, np.zeros(clip.shape, np.int64), components=4)


def test_forecasts_follow_the_model():
    clip = ripples(frames=40)
    texture = ef.dytex.learn(clip[:36], components=5)
    frames, states, error = ef.dytex.forecast(texture, 4)
    assert frames.shape == (4, *clip.shape[1:]) and states.shape == (5, 4) and (np.diff(error) >= 0).all()
    assert np.allclose(states[:, 1], texture.A @ states[:, 0]) and np.abs(frames[0] - clip[36]).mean() < 10
    later = ef.dytex.forecast(texture, 1, clip)[0]
    assert not np.allclose(later[0], frames[0])


def test_noise_of_few_directions():
    full, few = ef.dytex.learn(ripples(frames=80), components=4), ef.dytex.learn(ripples(frames=80), components=4, noise_rank=2)
    assert few.B.shape == (4, 2) and 0 < few.noise_share < 1 and full.noise_share == 1
    with pytest.raises(ValueError, match="noise_rank is 5"):
        ef.dytex.learn(ripples(), components=4, noise_rank=5)


def test_learning_curve_falls():
    table, found = ef.dytex.learning_curve(ripples(frames=60), components=4, lengths=6, targets=4)
    assert (table["error"] > table["left_out"]).all() and table["error"].iloc[-1] < found["frame_before"]


def test_distances_of_textures():
    a, b = ef.dytex.learn(ripples(), components=4), ef.dytex.learn(ripples(seed=1), components=4)
    matrices = ef.dytex.distance_matrices([a, b, a])
    assert set(matrices) == {"kl", "martin", "angles", "windows"}
    assert matrices["kl"][0, 1] > 0 == matrices["kl"][0, 2]
    exact = ef.dytex.learn(ripples(frames=6), components=5)
    assert exact.r == 0
    lacking = ef.dytex.distance_matrices([a, exact, b])["kl"]
    assert lacking[0, 2] == matrices["kl"][0, 1] and np.isnan(lacking[1]).all() and np.isnan(lacking[:, 1]).all()


def test_windows_know_a_texture_elsewhere():
    clip = np.random.default_rng(1).integers(0, 255, (70, 48, 96)).astype(np.uint8)
    slow = np.repeat(clip[:35], 2, axis=0)
    here, there, other = (ef.dytex.window_spectrum(part) for part in (clip[:, :, :48], clip[:, :, 48:], slow))
    assert ef.dytex.window_distance(here, there) < 1 < 2 < ef.dytex.window_distance(here, other)
    assert ef.dytex.window_spectrum(clip[:20]) is None and ef.dytex.window_spectrum(np.repeat(clip[:1], 40, axis=0)) is None
    model = ef.dytex.learn(clip, components=4)
    assert ef.dytex.window_spectrum(model).shape == here.shape
    with pytest.raises(ValueError, match="bands"):
        ef.dytex.window_distance(here, here[:3])


def test_a_region_moves_alone():
    clip = ripples()
    mask = np.zeros(clip.shape[1:], bool)
    mask[4:12, 6:20] = True
    texture = ef.dytex.learn_region(clip, mask, components=4)
    new = texture.synthesize(10)
    assert (new[:, ~mask] == new[0, ~mask]).all() and (new[:, mask] != new[0, mask]).any()


def test_quilts_can_be_guided_and_measured():
    clip = ripples(frames=4, height=40, width=60)
    guide = np.broadcast_to(np.linspace(0, 255, 60, dtype=np.float32), (40, 60))
    wanted = np.broadcast_to(np.linspace(255, 0, 90, dtype=np.float32), (40, 90))
    _, free = ef.quilt(clip, size=(90, 40), block=(16, 16), overlap=4, return_map=True)
    _, led = ef.quilt(clip, size=(90, 40), block=(16, 16), overlap=4, guide=guide, output_guide=wanted, guide_weight=0.95, return_map=True)

    def follows(places):
        return np.corrcoef(guide[places[..., 2], places[..., 1]].ravel(), wanted.ravel())[0, 1]

    assert follows(led) > 0.8 > follows(free)
    measured = ef.measure_quilt(led, clip)
    assert 0 < measured["seam_share"] < 1 and 0 < measured["source_share"] <= 1
    with pytest.raises(ValueError, match="guide has the shape"):
        ef.quilt(clip, guide=np.zeros(3, np.float32))
