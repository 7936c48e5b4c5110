# SPDX-License-Identifier: Apache-2.0
"""Clips for the tests, made of numbers."""
import numpy as np


def bars(frames=24, height=96, width=128, seed=0, colour=False):
    """Two bright bars that sway, in noise; half way through the clip the one is cut in two."""
    noise = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width]
    clip = np.empty((frames, height, width), np.float32)
    for t in range(frames):
        sway = 2 * np.sin(t / 3)
        across = 110 * np.exp(-((y - 30 - sway) ** 2) / 6) * ((x > 15) & (x < 110))
        down = 90 * np.exp(-((x - 60 - sway - y / 8) ** 2) / 6) * ((y > 50) & (y < 88))
        clip[t] = 60 + across + down
        if t >= frames // 2:
            clip[t][(x > 55) & (x < 75) & (y < 45)] = 60
    clip += noise.normal(0, 2, clip.shape)
    clip = np.clip(clip, 0, 255).astype(np.uint8)
    return np.stack([clip, clip // 2, 255 - clip], -1) if colour else clip


def ripples(frames=40, height=24, width=32, seed=0, colour=False):
    """Waves that a linear dynamic texture can learn."""
    noise = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width]
    t = np.arange(frames)[:, None, None]
    clip = 128 + 40 * np.sin(x / 3 + t / 2) + 20 * np.cos(y / 2 - t / 3) + noise.normal(0, 3, (frames, height, width))
    clip = np.clip(clip, 0, 255).astype(np.uint8)
    return np.stack([clip, 255 - clip, clip // 3], -1) if colour else clip
