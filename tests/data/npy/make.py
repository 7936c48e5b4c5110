# SPDX-License-Identifier: Apache-2.0
"""Writes the .npy files beside it with NumPy (1.24): the values are those of tests/core/npy_test.cpp."""
import pathlib
import numpy as np

here = pathlib.Path(__file__).resolve().parent
values = {
    "f2": [0, -1.5, 3.25, 5.9604644775390625e-08, 65504, -np.inf],
    "f4": [0, -1.5, 3.25, 1.401298464324817e-45, 3.4028234663852886e38, -np.inf],
    "f8": [0, -1.5, 0.1, 5e-324, 1.7976931348623157e308, -np.inf],
    "u1": [0, 1, 2, 127, 128, 255],
    "u2": [0, 1, 258, 32768, 65534, 65535],
    "i4": [0, -1, 1, 0x01020304, -(2**31), 2**31 - 1],
    "i8": [0, -1, 1, 0x0102030405060708, -(2**63), 2**63 - 1],
}
for code, numbers in values.items():
    for order, name in (("<", "le"), (">", "be")):
        if code == "u1" and name == "be":
            continue
        table = np.array(numbers, dtype=order + code).reshape(2, 3)
        np.save(here / f"{code}_{name}_c.npy", table)
        np.save(here / f"{code}_{name}_f.npy", np.asfortranarray(table))

cube = np.arange(24, dtype="<i4").reshape(2, 3, 4)
np.save(here / "cube_c.npy", cube)
np.save(here / "cube_f.npy", np.asfortranarray(cube))
np.save(here / "zero_d.npy", np.array(-2.5))
np.save(here / "one_d.npy", np.arange(5, dtype="<u2"))
np.save(here / "no_elements.npy", np.zeros((3, 0, 2), dtype="<f4"))
np.save(here / "many_axes.npy", np.array([1.5, -2.5], dtype="<f8").reshape((1,) * 19 + (2,)))
for version in ((2, 0), (3, 0)):
    with open(here / f"version_{version[0]}.npy", "wb") as file:
        np.lib.format.write_array(file, np.arange(3, dtype=">i4"), version=version)
# Floats, many of them half way between two halves, and what NumPy rounds them to.
rng = np.random.default_rng(1)
bits = rng.integers(0, 2**32, 1024, dtype="<u4")
near = (rng.integers(0x32800000, 0x47800000, 1024).astype("<u4") & 0xFFFFF000)  # halves and the ties between
floats = np.concatenate([bits.view("<f4"), near.view("<f4"), -near.view("<f4")])
floats = floats[~np.isnan(floats)]
np.save(here / "floats.npy", floats)
with np.errstate(over="ignore"):
    np.save(here / "floats_as_f2.npy", floats.astype("<f2"))
np.save(here / "refused_f16.npy", np.ones(2, dtype="<f16"))
np.save(here / "refused_complex.npy", np.ones(2, dtype="<c8"))
np.save(here / "refused_text.npy", np.array(["ab", "c"]))
np.save(here / "refused_object.npy", np.array([None, 1], dtype=object))
np.save(here / "refused_record.npy", np.zeros(1, dtype=[("x", "<f4"), ("y", "<i4")]))
