"""What stochastic hashing costs in noise: the prediction for one photon a bucket, and what it is compared with.

Photons of one pass are thought of as a Poisson process of equal flux on a plane along the grid's axes. With lambda
photons in a query's disc, P photons and T buckets, an estimate that sees one of a bucket's n photons, n-fold, has the
variance of the full list times

    1 + lambda kappa(c / r) + P / T

where c is the side of a cell and r the query's radius: a photon of the disc shares its bucket with others of its own
cell (kappa), and with those that the hash brings there (P / T). With memoryless radii passes are independent and every
radius of a pass is the same share of the first, so that the image of n passes obeys the same formula with the harmonic
mean of the passes' lambda.
"""

from dataclasses import dataclass

import numpy as np


def kappa(cells: float) -> float:
    """kappa of cells that are `cells` radii wide: c^2 / (pi r^2) - E[sum of A_c^2] / (pi r^2)^2.

    A_c is the disc's area in a cell. The second term is the chance that two points of the disc lie in the same cell of
    a grid whose origin is random: of points that are (x, y) apart, max(0, 1 - |x| / c) max(0, 1 - |y| / c). It is
    integrated over the distances of two points of a disc.
    """
    distance = (np.arange(2000) + 0.5) / 1000.0  # in radii: 0 to 2
    angle = (np.arange(500) + 0.5) / 500.0 * np.pi / 2.0
    half = distance / 2.0
    density = 4.0 * distance / np.pi * (np.arccos(half) - half * np.sqrt(1.0 - half**2))
    along = np.clip(1.0 - np.outer(distance, np.cos(angle)) / cells, 0.0, None)
    across = np.clip(1.0 - np.outer(distance, np.sin(angle)) / cells, 0.0, None)
    same_cell = float(np.sum(density * np.mean(along * across, axis=1)) / 1000.0)
    return cells**2 / np.pi - same_cell


def memoryless_shrinking(passes: int, alpha: float) -> np.ndarray:
    """r_i^2 / r_1^2 of each pass with memoryless radii: r_{i+1}^2 / r_i^2 = (i + alpha) / (i + 1), i from 1."""
    i = np.arange(1, passes)
    return np.concatenate([[1.0], np.cumprod((i + alpha) / (i + 1.0))])


def harmonic_share(passes: int, alpha: float) -> float:
    """The harmonic mean of r_i^2 / r_1^2 over the passes: lambda of the image over that of its first pass."""
    return float(passes / np.sum(1.0 / memoryless_shrinking(passes, alpha)))


def noise_of_passes(passes: int, alpha: float) -> float:
    """Variance of the mean of so many passes over that of the first: the mean of r_1^2 / r_i^2, over the passes."""
    return 1.0 / (passes * harmonic_share(passes, alpha))


def photons_in_disc(relative_variance: float, passes: int) -> float:
    """lambda (harmonic mean over passes) from the full list's own noise: that of a Poisson count is 1 / lambda a pass.

    Photons of unequal flux, and whatever else is noisy in a pixel, make the variance larger and this lambda too small.
    """
    return 1.0 / (passes * relative_variance)


def predicted_ratio(in_disc: float, photons_per_bucket: float, cells: float) -> float:
    """Variance with one photon a bucket over variance with all photons."""
    return 1.0 + in_disc * kappa(cells) + photons_per_bucket


@dataclass(frozen=True)
class Measured:
    """A ratio of variances with its 95 % interval."""

    ratio: float
    low: float
    high: float


def relative_variance(images: np.ndarray) -> float:
    """Variance over seeds over the squared mean, each a mean over pixels; `images` is seeds x height x width."""
    images = images.astype(np.float64)
    variance = images.var(axis=0, ddof=1)
    # The square of a noisy mean is too large by the mean's own variance.
    return float(variance.mean() / (images.mean(axis=0) ** 2 - variance / len(images)).mean())


def variance_ratio(noisy: np.ndarray, quiet: np.ndarray, draws: int = 2000) -> Measured:
    """Variance over seeds, summed over pixels, of one stack of images over another's.

    The interval is a bootstrap over seeds. Both stacks have the same seeds, thus the same photons: each draw takes the
    same seeds of both.
    """

    def draws_of(images: np.ndarray) -> np.ndarray:
        chance = np.random.default_rng(1)
        flat = images.reshape(len(images), -1).astype(np.float64)
        products = flat @ flat.T  # sums over pixels need no more than this
        found = np.empty(draws + 1)
        for i in range(draws + 1):
            seeds = np.arange(len(flat)) if i == 0 else chance.integers(len(flat), size=len(flat))
            chosen = products[np.ix_(seeds, seeds)]
            found[i] = (np.trace(chosen) - chosen.mean() * len(flat)) / (len(flat) - 1)
        return found

    of_noisy, of_quiet = draws_of(noisy), draws_of(quiet)
    usable = of_quiet[1:] > 0.0  # a draw may take the same seed every time
    low, high = np.quantile(of_noisy[1:][usable] / of_quiet[1:][usable], [0.025, 0.975])
    return Measured(float(of_noisy[0] / of_quiet[0]), float(low), float(high))
