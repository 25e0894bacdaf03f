"""Parts of the accuracy experiment that need no records: theory, judgements, where pixels lie, names of parameters."""

import itertools
import math

import numpy as np
import pytest
from accuracy import forecast, knobs, slopes, theory
from lab.statistics import LATER, Reached, log_slope


@pytest.mark.parametrize(
    ("low", "high", "halved", "outcome"),
    [
        (1.0, 3.0, Reached(2.0), forecast.RIGHT),
        (1.0, 3.0, Reached(0.5), forecast.WRONG),
        (1.0, math.inf, Reached(99.0), forecast.RIGHT),
        (1.0, 3.0, Reached(4.0, LATER), forecast.WRONG),
        (1.0, 3.0, Reached(0.5, LATER), forecast.RIGHT),
        (1.0, 3.0, Reached(2.0, LATER), forecast.OPEN),
    ],
)
def test_forecasts_are_right_wrong_or_open(low, high, halved, outcome):
    assert forecast.judge(low, high, halved) == outcome


def test_radii_follow_the_recurrence():
    found = theory.scale(np.arange(6), 0.7)
    factors = [(i + 0.7) / (i + 1) for i in range(1, 6)]
    assert found == pytest.approx(list(itertools.accumulate(factors, lambda a, b: a * b, initial=1.0)))


def test_a_disk_under_the_light_has_the_mean_that_calculus_says():
    """Over a disk about the foot the mean of (1 + d^2)^(-3/2) is 2/r^2 (1 - 1/sqrt(1 + r^2))."""
    found = theory.disk_mean(np.array([0.0]), 0.5, 1.0)[0]
    assert found == pytest.approx(2 / 0.25 * (1 - 1 / math.sqrt(1.25)), rel=1e-9)


def test_theory_of_many_passes_tends_to_its_limits():
    passes = [2**10, 2**14]
    bias, variance = theory.point_light_parts(np.array([0.0, 0.3]), passes, 0.7, 0.2, 0.9, 5000)
    assert log_slope(passes, variance) == pytest.approx(theory.variance_limit(0.7), abs=0.01)
    assert log_slope(passes, bias) == pytest.approx(theory.bias_limit(0.7), abs=0.05)


def test_pixels_lie_where_the_scene_has_them():
    found = slopes.distances((4, 4), [0.25, 0.75])
    assert found[0, 2] == pytest.approx(0.0)
    assert found[3, 0] == pytest.approx(math.hypot(1.0, 1.5))


def test_parameters_are_set_in_their_place():
    assert knobs.with_parameter("sppm", "alpha", 0.5) == "sppm:alpha=0.5"
    assert knobs.with_parameter("sppm:alpha=0.7,store=0", "alpha", 0.5) == "sppm:store=0,alpha=0.5"
