"""Fits, quantiles, censoring, bias and variance of the experiments, on data whose answer is known."""

import math

import numpy as np
import pytest
from lab.statistics import (
    EARLIER,
    LATER,
    Interval,
    Reached,
    bands,
    binomial_interval,
    common_grid,
    error_parts,
    halvings,
    jackknife,
    log_interpolate,
    log_slope,
    mean_interval,
    median_time,
    misses_by_chance,
    time_to_reach,
)


@pytest.mark.parametrize("slope", [-1.0, -2 / 3, 0.0, 0.5])
def test_slope_of_a_power_law(slope):
    x = np.array([1.0, 2.0, 5.0, 30.0])
    assert log_slope(x, 7.0 * x**slope) == pytest.approx(slope, abs=1e-12)


@pytest.mark.parametrize(("x", "y"), [([], []), ([1.0], [1.0]), ([2.0, 2.0], [1.0, 3.0]), ([1.0, 2.0], [1.0, -1.0])])
def test_no_slope_without_two_places_or_of_what_is_not_positive(x, y):
    assert math.isnan(log_slope(x, y))


def test_confidence_intervals_cover_as_often_as_they_say():
    """1800 of 2000 intervals of 90 % cover the value: the standard deviation of that number is 13.4."""
    random = np.random.default_rng(1)
    samples = random.normal(3.0, 2.0, (2000, 5))
    covered = sum(mean_interval(row, 0.9).holds(3.0) for row in samples)
    assert abs(covered - 1800) < 5 * 13.4


def test_the_jackknife_of_a_mean_is_students_interval():
    values = np.array([1.0, 4.0, 2.0, 8.0])
    found, expected = jackknife(lambda one: float(np.mean(one)), values), mean_interval(values)
    assert (found.value, found.low, found.high) == pytest.approx((expected.value, expected.low, expected.high))


def test_too_few_samples_leave_the_interval_open():
    assert math.isnan(mean_interval([2.0]).low)
    assert mean_interval([2.0]).value == 2.0
    assert math.isnan(jackknife(lambda one: float(np.mean(one)), np.array([1.0, 2.0])).low)
    assert mean_interval([math.nan, 1.0, 3.0]).value == 2.0


def test_intervals_meet_where_they_overlap():
    assert Interval(0.0, -1.0, 1.0).meets(0.9, 5.0)
    assert not Interval(0.0, -1.0, 1.0).meets(1.1, 5.0)
    assert Interval(0.5, 0.25, 0.75).text() == "0.50 [0.25, 0.75]"
    assert Interval(0.5, math.nan, math.nan).text() == "0.50"


def test_binomial_interval_of_known_tables():
    found = binomial_interval(9, 10)
    assert (found.value, found.low, found.high) == pytest.approx((0.9, 0.5550, 0.9975), abs=1e-4)
    assert math.isnan(binomial_interval(0, 0).value)


def test_misses_that_chance_allows():
    """2 or more of 6 intervals at 95 % miss in 3.3 % of cases, 1 or more in 26 %."""
    assert misses_by_chance(6) == 1
    assert misses_by_chance(1) == 0
    assert misses_by_chance(0) == 0


def test_interpolation_is_straight_on_logarithmic_axes_and_never_beyond_the_ends():
    found = log_interpolate([0.5, 1.0, 2.0, 4.0, 5.0], [1.0, 4.0], [1.0, 1 / 16])
    assert found[1:4] == pytest.approx([1.0, 0.25, 1 / 16])
    assert np.isnan(found[[0, 4]]).all()


def test_a_common_grid_lies_within_every_curve():
    grid = common_grid([[0.1, 1.0, 3.0], [0.2, 2.0]], 5)
    assert (grid[0], grid[-1]) == pytest.approx((0.2, 2.0))
    assert np.diff(np.log(grid)) == pytest.approx(np.log(10) / 4)
    assert len(common_grid([[0.1, 0.2], [0.3, 0.4]], 5)) == 0
    assert len(common_grid([], 5)) == 0
    assert len(common_grid([[1.0]], 5)) == 0


def test_bands_are_quantiles_over_curves():
    low, middle, high = bands(np.array([[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]]), [0.0, 0.5, 1.0])
    assert (low[1], middle[0], high[1]) == (10.0, 2.0, 30.0)


def test_the_time_to_a_level_is_interpolated_or_censored():
    times, errors = [1.0, 2.0, 4.0], [1.0, 0.5, 0.25]
    assert time_to_reach(times, errors, 1 / math.sqrt(8)).time == pytest.approx(math.sqrt(8))
    assert time_to_reach(times, errors, 0.1) == Reached(4.0, LATER)
    assert time_to_reach(times, errors, 2.0) == Reached(1.0, EARLIER)
    assert time_to_reach(times, errors, 1.0) == Reached(1.0)
    assert time_to_reach(times, errors, 0.25).time == pytest.approx(4.0)


def test_the_first_of_several_crossings_counts():
    assert time_to_reach([1.0, 2.0, 3.0, 4.0], [1.0, 0.25, 1.0, 0.1], 0.5).time == pytest.approx(math.sqrt(2))


def test_a_median_that_rests_on_a_bound_is_a_bound():
    reached, later = Reached(1.0), Reached(5.0, LATER)
    found = median_time([later, reached, Reached(3.0)])
    assert (found.median.time, found.median.censored) == (3.0, "")
    assert found.high.censored == LATER
    assert (found.reached, found.count) == (2, 3)
    assert median_time([later, later, reached]).median == Reached(5.0, LATER)
    assert median_time([Reached(0.1, EARLIER), Reached(0.1, EARLIER), reached]).median == Reached(0.1, EARLIER)
    assert median_time([later, later]).text() == "> 5"
    assert median_time([reached, reached, Reached(3.0)]).text() == "1 (1 to 2.6)"


def test_halvings_of_a_power_law_cost_what_its_slope_says():
    times = np.geomspace(1.0, 100.0, 30)
    found = halvings(times, 8.0 * times**-0.5)
    assert [one.ratio for one in found] == pytest.approx([4.0] * 3)
    assert found[-1].end == pytest.approx(100.0)
    assert found[-1].seconds == pytest.approx(75.0)
    assert found[0].error == pytest.approx(6.4)
    assert halvings([1.0], [1.0]) == []
    assert halvings([1.0, 2.0], [1.0, 0.9]) == []


def test_bias_and_variance_apart():
    """1000 seeds of 50 pixels, bias 0.5, variance 4: standard errors of 0.025 (variance) and 0.009 (bias^2)."""
    random = np.random.default_rng(2)
    truth = random.uniform(1.0, 2.0, 50)
    parts = error_parts(truth + 0.5 + random.normal(0.0, 2.0, (1000, 50)), truth)
    assert parts.variance == pytest.approx(4.0, abs=5 * 0.025)
    assert parts.bias_squared == pytest.approx(0.25, abs=5 * 0.009)


def test_few_noisy_seeds_do_not_look_biased():
    """The mean of 3 seeds is off by a third of the variance, which is no bias."""
    random = np.random.default_rng(3)
    parts = error_parts(random.normal(0.0, 1.0, (3, 20000)), np.zeros(20000))
    assert abs(parts.bias_squared) < 0.03
    assert parts.variance == pytest.approx(1.0, abs=0.05)


def test_weights_of_pixels_count():
    images = np.array([[1.0, 2.0], [3.0, 2.0]])
    assert error_parts(images, np.zeros(2), np.array([0.0, 1.0])).variance == 0.0
    assert error_parts(images, np.array([2.0, 1.0]), np.array([0.0, 1.0])).bias_squared == pytest.approx(0.5)
