"""What theory says of memoryless progressive photon mapping after finitely many passes.

Pass i, from 0, has squared radii `scale(i, a)` times those of the first one (Knaus and Zwicker 2011). The image is the
mean of the passes: its bias is the mean of theirs, its variance the mean of theirs over their number. In the limit
variance falls as n^-a and squared bias as n^-(2-2a); after finitely many passes slopes are not there yet.
"""

import numpy as np
from scipy.special import gammaln

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
COSINES = np.cos((np.arange(24) + 0.5) * (2 * np.pi / 24))


def scale(passes: np.ndarray, alpha: float) -> np.ndarray:
    """Squared radii over that of the first pass: the product of (i + alpha) / (i + 1), i from 1, in closed form."""
    n = np.asarray(passes, dtype=float)
    return np.exp(gammaln(n + 1 + alpha) - gammaln(n + 2) - gammaln(1 + alpha))


def variance_limit(alpha: float) -> float:
    """Slope of the variance for n to infinity."""
    return -alpha


def bias_limit(alpha: float) -> float:
    """Slope of the squared bias for n to infinity, where radiance is smooth."""
    return -(2.0 - 2.0 * alpha)


def edge_limit(alpha: float) -> float:
    """Slope of the whole image's squared bias for n to infinity: an edge spoils a strip as wide as the radius."""
    return -(1.0 - alpha) / 2.0


def disk_mean(distance: np.ndarray, radius: float, height: float) -> np.ndarray:
    """Irradiance by a point light, averaged over disks on the floor, over that at the light's foot.

    `distance`: of the disks' centres from the foot. By Gauss and Legendre over the area, and evenly around.
    """
    rho = radius * np.sqrt((NODES + 1) / 2)
    squared = (
        distance[:, None, None] ** 2
        + rho[None, :, None] ** 2
        + 2 * distance[:, None, None] * rho[None, :, None] * COSINES
    )
    irradiance = (1 + squared / height**2) ** -1.5
    return np.sum(irradiance.mean(axis=2) * WEIGHTS / 2, axis=1)


def point_light_parts(
    distance: np.ndarray, passes: list[int], alpha: float, radius: float, height: float, photons: int
) -> tuple[np.ndarray, np.ndarray]:
    """Relative squared bias and variance under a point light after each of `passes`, averaged over pixels.

    A pass emits `photons` evenly into all directions; the number of them in a disk is binomial.
    """
    truth = (1 + distance**2 / height**2) ** -1.5
    radii = radius * np.sqrt(scale(np.arange(max(passes)), alpha))
    means = np.array([disk_mean(distance, one, height) for one in radii])
    share = means * (radii[:, None] / (2 * height)) ** 2
    bias = np.cumsum(means / truth - 1, axis=0)
    variance = np.cumsum((means / truth) ** 2 * (1 - share) / (share * photons), axis=0)
    last = np.asarray(passes) - 1
    n = np.asarray(passes, dtype=float)[:, None]
    return np.mean((bias[last] / n) ** 2, axis=1), np.mean(variance[last] / n**2, axis=1)
