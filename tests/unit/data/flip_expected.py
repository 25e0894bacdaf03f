#!/usr/bin/env python3
"""Writes flip_expected.json: what the authors' FLIP says about the image pairs that flip_test.cpp makes.

Needs numpy and flip-evaluator 1.7 from PyPI. The pairs are made here and in the test by the same integer arithmetic,
so that both have the same floats:

    python3 -m venv venv && venv/bin/pip install numpy flip-evaluator==1.7 && venv/bin/python flip_expected.py
"""

import json
import pathlib

import flip_evaluator
import numpy

MASK = 0xFFFFFFFF


def noise(x, y, c, seed):
    """A number in [0, 1) with 24 random bits (the finalizer of MurmurHash3 over a mix of the coordinates)."""
    h = (x * 0x9E3779B1 + y * 0x85EBCA77 + c * 0xC2B2AE3D + seed * 0x27D4EB2F) & MASK
    h = ((h ^ (h >> 16)) * 0x85EBCA6B) & MASK
    h = ((h ^ (h >> 13)) * 0xC2B2AE35) & MASK
    h ^= h >> 16
    return (h >> 8) / 16777216.0


def reference_value(x, y, c, size, peak):
    """Ramps in three directions, a checkerboard of 5 pixels in one quadrant, and a square lamp of `peak`."""
    width, height = size
    value = [x / width, y / height, (x + y) / (width + height)][c]
    if 2 * x < width and 2 * y < height:
        value = 0.125 if (x // 5 + y // 5 + c) % 2 else 0.75
    if width - 9 <= x < width - 4 and 4 <= y < 9:
        value = peak
    return value


def make(width, height, peak, amount, seed):
    """The reference, and the image: the reference times noise of width `amount`, and one pixel twice as bright."""
    reference = numpy.zeros((height, width, 3), dtype=numpy.float32)
    image = numpy.zeros_like(reference)
    for y in range(height):
        for x in range(width):
            for c in range(3):
                value = reference_value(x, y, c, (width, height), peak)
                reference[y, x, c] = value
                image[y, x, c] = value * (1.0 + amount * (noise(x, y, c, seed) - 0.5))
    image[height // 2, width // 2] *= 2.0
    return reference, image


CASES = [  # name, LDR or HDR, width, height, peak, amount, seed
    ("ldr_noise", "LDR", 40, 32, 1.0, 0.5, 1),
    ("ldr_faint", "LDR", 33, 29, 1.0, 0.01, 2),
    ("hdr_noise", "HDR", 40, 32, 200.0, 0.5, 3),
    ("hdr_strong", "HDR", 31, 37, 5.0, 2.0, 4),
    ("hdr_narrow", "HDR", 24, 7, 1.0, 0.2, 5),
]


def main():
    cases = []
    for name, dynamic_range, width, height, peak, amount, seed in CASES:
        reference, image = make(width, height, peak, amount, seed)
        if dynamic_range == "LDR":
            reference, image = reference.clip(0, 1), image.clip(0, 1)
        error, mean, parameters = flip_evaluator.evaluate(
            reference, image, dynamic_range, inputsRGB=False, applyMagma=False
        )
        case = {
            "name": name,
            "range": dynamic_range,
            "width": width,
            "height": height,
            "peak": peak,
            "amount": amount,
            "seed": seed,
            "mean": round(float(mean), 7),
            "error": [round(float(e), 5) for e in error.flatten()],
        }
        if dynamic_range == "HDR":
            case["start_exposure"] = round(parameters["startExposure"], 5)
            case["stop_exposure"] = round(parameters["stopExposure"], 5)
            case["exposures"] = parameters["numExposures"]
        cases.append(case)
    rows = ",\n".join(json.dumps(case) for case in cases)
    text = f'{{"evaluator": "flip-evaluator 1.7", "cases": [\n{rows}\n]}}\n'
    pathlib.Path(__file__).with_suffix(".json").write_text(text)


if __name__ == "__main__":
    main()
