# SPDX-License-Identifier: Apache-2.0
"""Sketches, rates and the motion model, step by step."""
import copy
import pickle

import numpy as np
import pytest

import emberfold as ef
from scenes import bars, ripples


@pytest.fixture(scope="module")
def frame():
    return bars(1)[0].astype(np.float32)


@pytest.fixture(scope="module")
def sketch(frame):
    return ef.sketch.extract(frame, sensitivity=0.5)


def test_anchors_and_patches_draw_the_frame(frame, sketch):
    drawn, mask = ef.sketch.draw_patches(frame, sketch)
    own, _ = ef.sketch.draw_patches(frame, sketch, "pixels")
    assert set(np.unique(mask)) == {0, 255} and np.array_equal(own[mask > 0], frame[mask > 0])
    share = (mask > 0).mean() + 0.1
    held = ef.sketch.add_anchors(sketch, frame, share)
    assert len(held.patches(0)) > len(sketch.patches(0))

    def error(graphs):
        return ((ef.sketch.reconstruct(frame, graphs).astype(float) - frame) ** 2).mean()

    assert error(held) < error(sketch)
    with pytest.raises(ValueError, match="patches is 'painted'"):
        ef.sketch.draw_patches(frame, sketch, "painted")


def test_fills(frame, sketch):
    drawn = ef.sketch.draw_patches(frame, sketch, "pixels")
    for kind in ("diffusion", "efros_leung"):
        filled = ef.sketch.fill_nonsketchable(frame, drawn, kind=kind)
        assert np.array_equal(filled[drawn[1] > 0], frame[drawn[1] > 0])
    grain = [(ef.sketch.fill_nonsketchable(frame, drawn, kind=kind) - frame)[60:, :30].std() for kind in ("diffusion", "efros_leung")]
    assert grain[1] > grain[0]
    film = ef.sketch.make_heat_film(frame, drawn[1] > 0, [0, 10, 100])
    assert np.array_equal(film[0], frame) and film.shape == (3, *frame.shape)


def test_rates_agree_with_closed_forms():
    mean, low, high = ef.rates.event_rate(0, 10)
    assert mean == low == 0 and np.isclose(high, -np.log(0.05) / 10)  # Garwood, of no event
    same = ef.rates.compare_rates(10, 5, 10, 5)
    assert same["ratio"][0] == 1 and np.isclose(same["p"], 1)
    group = ef.rates.group_rate([(4, 2.0), (6, 2.0), (5, 2.0)])
    assert np.isclose(group["rate"][0], 15 / 6) and group["dispersion"] >= 1
    apart = ef.rates.compare_groups([(2, 1.0), (3, 1.0), (2, 1.0), (1, 1.0)], [(20, 1.0), (22, 1.0), (19, 1.0), (25, 1.0)])
    assert apart["permuted"] and np.isclose(apart["p"], 2 / 70) and apart["ratio"][0] > 5
    with pytest.raises(ef.InputError):
        ef.rates.event_rate(3, 0)


def test_models_are_learned_of_graphs(run):
    model = ef.mcmc.fit(run.motion, calibrate=False)
    assert model == ef.mcmc.fit(run.motion, calibrate=False) == pickle.loads(pickle.dumps(model))
    assert ef.mcmc.spectral_radius(model.displacement) < 1
    ahead = ef.mcmc.predict(model, run.motion, 1)
    assert len(ahead) == run.frames and len(ahead.patches(0)) == 0 and len(ahead.patches(5)) == len(run.patches(4))
    told = ef.graph.event_statistics(run.motion)
    assert np.isclose(told["patches"], np.mean([len(run.patches(t)) for t in range(run.frames)]))
    drawn = ef.mcmc.synthesize(run.model.motion, 5, seed=3)
    assert len(drawn) == 5 and drawn == ef.mcmc.synthesize(run.model.motion, 5, seed=3)
    rates = model.rates
    again = pickle.loads(pickle.dumps(rates))
    assert again == rates == copy.deepcopy(rates)
    again.split *= 2
    assert again != rates


def test_graphs_have_a_likelihood_under_a_model(run):
    model = ef.mcmc.fit(run.motion, calibrate=False)
    told = ef.mcmc.transition_likelihoods(model, run.motion)
    assert list(told.index) == list(range(1, run.frames)) and np.isfinite(told).all().all()
    terms = ["displacement", "contrast", *ef.graph.EVENT_TYPES]
    assert np.allclose(told[terms].sum(axis=1), told["total"])
    other = copy.deepcopy(model)
    other.displacement.noise *= 5
    assert ef.mcmc.transition_likelihoods(other, run.motion)["total"].mean() < told["total"].mean()
    with pytest.raises(ef.InputError, match="two frames or more"):
        ef.mcmc.transition_likelihoods(model, ef.mcmc.synthesize(model, 1))


def test_graphs_run_backwards(run):
    back = ef.graph.reverse_time(run.motion)
    assert len(back.patches(0)) == len(run.patches(run.frames - 1)) and ef.graph.reverse_time(ef.graph.reverse_time(back)) == back
    forth = [e[1] for e in ef.graph.stroke_events(run.motion)]
    assert forth.count("birth") == [e[1] for e in ef.graph.stroke_events(back)].count("death")
    curves = ef.graph.curves_as_strokes(run.motion)
    assert set(curves.patches(5)["stroke"]) == set(run.patches(5)["curve"])


def test_a_graph_moves_into_another(sketch, run):
    one = ef.graph.morph(sketch, sketch, frames=4)
    assert one.length < 1e-9 and one.died == one.born == 0 and len(one.motion) == 4
    there = ef.graph.morph(run.motion.sketch, run.motion.sketch, at=0, to=-1, frames=5)
    back = ef.graph.morph(run.motion.sketch, run.motion.sketch, at=-1, to=0, frames=5)
    assert there.length > 0 and np.isclose(there.length, back.length) and (there.died, there.born) == (back.born, back.died)
    assert [len(o) for o in there.opacity] == [len(there.motion.patches(t)) for t in range(5)]
    frames = ef.sketch.draw_morph(there, channels=1)
    assert frames.dtype == np.uint8 and frames.shape == (5, there.motion.height, there.motion.width)
    with pytest.raises(ef.InputError, match="frames is 2"):
        ef.graph.morph(sketch, sketch, frames=2)


def test_measures_of_frames_and_clips():
    clip = ripples(frames=24)
    frame = clip[0].astype(np.float32)
    moved = np.roll(np.kron(frame, np.ones((4, 4), np.float32)), 2, axis=1)
    flow = ef.measures.optical_flow(np.kron(frame, np.ones((4, 4), np.float32)), moved)
    assert flow.shape == (*moved.shape, 2)
    assert np.allclose(ef.measures.autocorrelation(np.repeat(clip[:1], 9, axis=0), 3), 1)
    spectrum = ef.measures.temporal_spectrum(clip, 8)
    assert ef.measures.log_spectral_distance(spectrum, spectrum) == 0
    blurred = np.repeat(np.repeat(frame[::2, ::2], 2, 0), 2, 1)
    assert ef.measures.crease_sharpness(frame)["points"] > 0 and ef.measures.crease_sharpness(blurred)["gradient"] > 0


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
    for name in ("LearnOptions", "SynthesisOptions", "EmOptions", "CurveOptions", "BinetCauchyOptions", "StarOptions"):
        told = {text.rsplit("::", 1)[1] for text in TEXTS if text.startswith(f"dytex::{name}::")} - {"validate"}
        assert not told - set(getattr(ef.dytex, name).FIELDS), name
