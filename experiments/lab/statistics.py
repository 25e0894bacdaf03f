"""Statistics of the experiments: slopes with their confidence, curves, censored times, bias and variance apart.

Curves are compared on logarithmic axes, and only within the range that was measured: nothing is extrapolated. A level
that a curve does not reach is censored: the time is known to be longer than the run (`LATER`). One that it is below
from its first entry on was reached before that (`EARLIER`).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

EARLIER, LATER = "earlier", "later"
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Interval:
    """An estimate and its confidence interval; the bounds are NaN where there is too little to tell."""

    value: float
    low: float
    high: float

    def holds(self, value: float) -> bool:
        """Whether a value lies inside."""
        return self.low <= value <= self.high

    def meets(self, low: float, high: float) -> bool:
        """Whether it has something in common with [low, high]."""
        return self.low <= high and low <= self.high

    def text(self, digits: int = 2) -> str:
        """VALUE [LOW, HIGH]."""
        if not math.isfinite(self.value):
            return ""
        if not math.isfinite(self.low):
            return f"{self.value:.{digits}f}"
        return f"{self.value:.{digits}f} [{self.low:.{digits}f}, {self.high:.{digits}f}]"


def log_slope(x: Sequence[float], y: Sequence[float]) -> float:
    """d log y / d log x by least squares; NaN for fewer than two different places or a y that is not above 0."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if len(np.unique(x)) < 2 or np.any(x <= 0) or not np.all(y > 0):
        return math.nan
    u, v = np.log(x), np.log(y)
    u = u - u.mean()
    return float(np.sum(u * (v - v.mean())) / np.sum(u * u))


def mean_interval(values: Sequence[float], confidence: float = CONFIDENCE) -> Interval:
    """The mean of independent values, by Student's t."""
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return Interval(math.nan, math.nan, math.nan)
    mean = float(values.mean())
    if len(values) < 2:
        return Interval(mean, math.nan, math.nan)
    reach = stats.t.ppf(0.5 + confidence / 2, len(values) - 1) * values.std(ddof=1) / math.sqrt(len(values))
    return Interval(mean, mean - float(reach), mean + float(reach))


def paired_log_difference(first: Sequence[float], second: Sequence[float], confidence: float = CONFIDENCE) -> Interval:
    """The mean of log(first / second) over pairs, by Student's t: what both of a pair share, drops out."""
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    if len(first) != len(second):
        raise ValueError(f"{len(first)} and {len(second)} numbers are no pairs")
    kept = (first > 0) & (second > 0)
    return mean_interval(np.log(first[kept] / second[kept]), confidence)


def jackknife(
    statistic: Callable[[np.ndarray], float], samples: np.ndarray, confidence: float = CONFIDENCE
) -> Interval:
    """A statistic of samples (along the first axis), with Student's interval from leaving one out at a time."""
    count = len(samples)
    value = float(statistic(samples))
    if count < 3:
        return Interval(value, math.nan, math.nan)
    left_out = np.array([statistic(np.delete(samples, i, axis=0)) for i in range(count)])
    error = math.sqrt((count - 1) / count * float(np.sum((left_out - left_out.mean()) ** 2)))
    reach = float(stats.t.ppf(0.5 + confidence / 2, count - 1)) * error
    return Interval(value, value - reach, value + reach)


def binomial_interval(hits: int, count: int, confidence: float = CONFIDENCE) -> Interval:
    """A share and Clopper and Pearson's interval of it."""
    if count == 0:
        return Interval(math.nan, math.nan, math.nan)
    found = stats.binomtest(hits, count).proportion_ci(confidence, method="exact")
    return Interval(hits / count, float(found.low), float(found.high))


def misses_by_chance(count: int, confidence: float = CONFIDENCE, chance: float = 0.1) -> int:
    """How many of `count` right intervals may miss: more of them do in fewer than `chance` of all cases."""
    return int(stats.binom.ppf(1.0 - chance, count, 1.0 - confidence)) if count else 0


def log_interpolate(at: Sequence[float], x: Sequence[float], y: Sequence[float]) -> np.ndarray:
    """y at some places, by straight lines on logarithmic axes; NaN outside of the measured range. x ascends."""
    at, x, y = (np.asarray(one, dtype=float) for one in (at, x, y))
    if len(x) == 0:
        return np.full(len(at), np.nan)
    found = np.exp(np.interp(np.log(at), np.log(x), np.log(y)))
    # The ends of a common grid come from these very numbers: rounding must not put them outside.
    outside = (at < x[0] * (1 - 1e-12)) | (at > x[-1] * (1 + 1e-12))
    return np.where(outside, np.nan, found)


def common_grid(curves: Sequence[Sequence[float]], points: int) -> np.ndarray:
    """Places, evenly on a logarithmic axis, that lie within the range of every curve; empty if no two are."""
    if not curves or any(len(one) == 0 for one in curves):
        return np.array([])
    first, last = max(one[0] for one in curves), min(one[-1] for one in curves)
    return np.geomspace(first, last, points) if 0 < first < last else np.array([])


def bands(rows: np.ndarray, quantiles: Sequence[float]) -> list[np.ndarray]:
    """Quantiles over curves: `rows` has a curve in each row."""
    return [np.quantile(rows, q, axis=0) for q in quantiles]


@dataclass(frozen=True)
class Reached:
    """When a level was reached. `censored` says that this is only a bound: EARLIER than `time`, or LATER."""

    time: float
    censored: str = ""

    def text(self) -> str:
        """The time, or the bound."""
        sign = {EARLIER: "< ", LATER: "> ", "": ""}[self.censored]
        return f"{sign}{self.time:.3g}"


def time_to_reach(times: Sequence[float], errors: Sequence[float], level: float) -> Reached:
    """When a curve first comes down to a level."""
    times, errors = np.asarray(times, dtype=float), np.asarray(errors, dtype=float)
    below = np.flatnonzero(errors <= level)
    if len(below) == 0:
        return Reached(float(times[-1]), LATER)
    i = int(below[0])
    if i == 0:
        return Reached(float(times[0]), "" if errors[0] == level else EARLIER)
    share = math.log(errors[i - 1] / level) / math.log(errors[i - 1] / errors[i]) if errors[i] > 0 else 1.0
    return Reached(float(times[i - 1] * (times[i] / times[i - 1]) ** share))


@dataclass(frozen=True)
class TimeOfSeeds:
    """The median over seeds of a time, and its quantiles; each may be a bound only. `reached`: seeds that got there."""

    median: Reached
    low: Reached
    high: Reached
    reached: int
    count: int

    def text(self) -> str:
        """The median, and its spread where that is known."""
        if self.median.censored or self.count == 1:
            return self.median.text()
        return f"{self.median.text()} ({self.low.text()} to {self.high.text()})"


def median_time(found: Sequence[Reached], low: float = 0.1, high: float = 0.9) -> TimeOfSeeds:
    """Order statistics of times that may be censored: one that rests on a bound is a bound."""
    ordered = sorted(found, key=lambda one: ([EARLIER, "", LATER].index(one.censored), one.time))
    reached = sum(one.censored != LATER for one in found)
    median, below, above = (_quantile(ordered, q) for q in (0.5, low, high))
    return TimeOfSeeds(median, below, above, reached, len(found))


def _quantile(ordered: Sequence[Reached], q: float) -> Reached:
    place = q * (len(ordered) - 1)
    before, after = ordered[math.floor(place)], ordered[math.ceil(place)]
    share = place - math.floor(place)
    time = before.time * (1 - share) + after.time * share
    kinds = {before.censored, after.censored}
    return Reached(time, LATER if LATER in kinds else EARLIER if EARLIER in kinds else "")


@dataclass(frozen=True)
class Halving:
    """What it took to halve an error along a curve: from `error` at `start` to half of it at `end`."""

    error: float
    start: float
    end: float

    @property
    def seconds(self) -> float:
        """How long it took."""
        return self.end - self.start

    @property
    def ratio(self) -> float:
        """How many times as long everything has taken by then: 2 where the error falls as 1/time."""
        return self.end / self.start


def halvings(times: Sequence[float], errors: Sequence[float]) -> list[Halving]:
    """The halvings that a curve makes, counted back from its end, earliest first."""
    found: list[Halving] = []
    if len(times) < 2:
        return found
    level = 2.0 * float(errors[-1])
    while level <= errors[0]:
        start, end = (time_to_reach(times, errors, one) for one in (level, level / 2))
        found.insert(0, Halving(level, start.time, end.time))
        level *= 2.0
    return found


@dataclass(frozen=True)
class ErrorParts:
    """Expected error of one image, apart: `variance` over seeds, and `bias_squared` (which noise may bring below 0)."""

    variance: float
    bias_squared: float


def error_parts(images: np.ndarray, truth: np.ndarray, weight: np.ndarray | float = 1.0) -> ErrorParts:
    """Bias and variance of images (seeds first), weighted and averaged over pixels.

    The squared distance of the mean from the truth holds 1/seeds of the variance, too, which is subtracted.
    """
    count = len(images)
    variance = images.var(axis=0, ddof=1)
    squared = (images.mean(axis=0) - truth) ** 2 - variance / count
    return ErrorParts(float(np.mean(weight * variance)), float(np.mean(weight * squared)))
