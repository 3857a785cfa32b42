"""SCENE.xml REFERENCE.exr SPP [NAME=VALUE]: Mitsuba's error at SPP samples a pixel, as one JSON object.

The reference is rendered with 4096 samples if there is no such file. Errors are defined as host-sim defines them: light
above 8 counts as 8 in the bias, FLIP sees sRGB clipped to 0..1.
"""
import json
import os
import sys

import flip_evaluator
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
file, reference, spp = sys.argv[1], sys.argv[2], int(sys.argv[3])
scene = mi.load_file(file, **dict(pair.split("=", 1) for pair in sys.argv[4:]))


def linear(bitmap):
    rgb = bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
    return np.array(rgb, dtype=np.float64)


def srgb(light):
    x = np.clip(light, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055).astype(np.float32)


if not os.path.exists(reference):
    # Another seed: the two pictures must not share their noise.
    mi.Bitmap(mi.render(scene, spp=4096, seed=1)).write(reference)
truth = linear(mi.Bitmap(reference))
picture = linear(mi.Bitmap(mi.render(scene, spp=spp, seed=2)))
mean = np.minimum(truth, 8).mean()
bias = (np.minimum(picture, 8).mean() - mean) / mean
_, flip, _ = flip_evaluator.evaluate(srgb(truth), srgb(picture), "LDR")
print(json.dumps({"bias": float(bias), "flip": float(flip)}))
