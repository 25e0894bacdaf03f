"""Images of runs: reading EXR, error and FLIP maps, pictures for figures, and the viewer's entries."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import flip_evaluator
import numpy as np
import OpenEXR

from lab.catalogue import Reference
from lab.runs import ROOT, Run
from lab.sections import Image
from lab.store import Store


def read_exr(path: Path, channels: Sequence[str] = "RGB") -> np.ndarray:
    """An EXR as float32, height x width x len(channels); a crop's data window only."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        found = file.channels()
        return np.stack([found[name].pixels.astype(np.float32) for name in channels], axis=-1)


def write_map(path: Path, values: np.ndarray) -> None:
    """A map of one number per pixel, height x width, as the channel Y."""
    path.parent.mkdir(parents=True, exist_ok=True)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"Y": np.ascontiguousarray(values, dtype=np.float32)}) as file:
        file.write(str(path))


def write_picture(path: Path, image: np.ndarray) -> None:
    """A picture of scene-linear light, height x width x 3, as halfs."""
    path.parent.mkdir(parents=True, exist_ok=True)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    planes = {name: np.ascontiguousarray(image[..., i], dtype=np.float16) for i, name in enumerate("RGB")}
    with OpenEXR.File(header, planes) as file:
        file.write(str(path))


def luminance(image: np.ndarray) -> np.ndarray:
    """Rec.709 luminance, height x width."""
    return image @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)


def relative_squared_error(image: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """(I - R)^2 / (R^2 + 0.01), the mean over channels: relMSE's error of each pixel (docs/metrics.md)."""
    return np.mean((image - reference) ** 2 / (reference**2 + 0.01), axis=-1)


def encode(image: np.ndarray, exposure: float = 0.0) -> np.ndarray:
    """Scene-linear light as a display shows it: sRGB's curve, cut to [0, 1]."""
    light = np.clip(np.nan_to_num(image * 2.0**exposure), 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1.0 / 2.4) - 0.055)


def exposure_of(reference: np.ndarray) -> float:
    """Stops that bring the 95th percentile of luminance to 0.8: one exposure for all images of a scene."""
    bright = float(np.percentile(luminance(reference), 95))
    return float(np.log2(0.8 / bright)) if bright > 0.0 else 0.0


def flip_map(image: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, float]:
    """HDR-FLIP of each pixel and its mean, by the authors' flip-evaluator."""
    finite = [np.nan_to_num(one, posinf=65504.0, neginf=-65504.0) for one in (reference, image)]
    values, mean, _ = flip_evaluator.evaluate(*finite, "HDR", applyMagma=False)
    return values[..., 0] if values.ndim == 3 else values, float(mean)


@dataclass
class Gallery:
    """Makes the viewer's entries of runs of one scene; maps go into the target's folder."""

    store: Store
    folder: Path  # the target's

    def relative(self, path: Path) -> str:
        """A file of the reproduction, as sections name it."""
        return str(path.resolve().relative_to(self.store.folder.resolve()))

    def of_run(self, name: str, method: str, run: Run) -> Image:
        """The image of a run, with its errors and a FLIP map where it has a reference."""
        record, key = self.store.record(run), self.store.key(run)
        statistics = record["statistics"]
        facts = f"{statistics['passes']} passes, {statistics['wall_s']:.1f} s"
        if statistics["photons_emitted"]:
            facts += f", {statistics['photons_emitted']:.3g} photons"
        entry = Image(name, method, self.relative(self.store.image(run)), " ".join(record["command"]), key, facts)
        if run.reference:
            image, reference = read_exr(self.store.image(run)), read_exr(self.reference_path(run.reference))
            entry.errors = {word: record["compare"][word] for word in ("relmse", "relmse_trimmed", "mape")}
            values, entry.errors["flip"] = flip_map(image, reference)
            path = self.folder / "maps" / f"flip-{key}.exr"
            write_map(path, values)
            entry.flip_map = self.relative(path)
        return entry

    def of_reference(self, reference: Reference) -> Image:
        """The scene's reference; an image of the project's tree is copied, so that the page stands alone."""
        if reference.run:
            entry = self.of_run("reference", "reference", reference.run)
            return Image(**{**vars(entry), "facts": f"{reference.by}: {entry.facts}"})
        source = ROOT / reference.image
        copy = self.folder / "maps" / source.name
        copy.parent.mkdir(parents=True, exist_ok=True)
        if not copy.exists() or copy.read_bytes() != source.read_bytes():
            copy.write_bytes(source.read_bytes())
        return Image("reference", "reference", self.relative(copy), f"({reference.image})", "", reference.by)

    def reference_path(self, reference: Run | str) -> Path:
        """Where a reference's image lies."""
        return self.store.image(reference) if isinstance(reference, Run) else ROOT / reference


def reference_error(reference: Reference, store: Store) -> dict:
    """What is known of a reference's own error: `relmse` (or None), and `how` that is known.

    From its standard error per pixel where another program left one, from the estimate of the run that rendered it
    (noise, and bias where the integrator estimates it) otherwise.
    """
    if reference.run:
        estimate = store.record(reference.run)["statistics"]["estimated_error"]
        return {"relmse": estimate, "how": "the run's own estimate", "runs": [store.key(reference.run)]}
    if not reference.error_image:
        return {"relmse": None, "how": "not known", "runs": []}
    image, error = read_exr(ROOT / reference.image), read_exr(ROOT / reference.error_image)
    return {"relmse": float(np.mean(error**2 / (image**2 + 0.01))), "how": "its standard error per pixel", "runs": []}
