"""What is compared, read from the declarations: methods.toml, scenes.toml, and an experiment.toml per experiment."""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from lab.runs import ROOT, Run

EXPERIMENTS = ROOT / "experiments"
# What becomes of a method's bias with time: there is none, it vanishes, it stays. The last: nobody has said.
NO_BIAS, VANISHES, STAYS, NOT_SAID = BIASES = ("none", "vanishes", "stays", "")
_KEYS = {
    "integrators": ("use", "plugin", "label", "structures", "eye_samples", "bias"),
    "structures": ("use", "plugin", "label", "kernels"),
}


class DeclarationError(Exception):
    """A declaration names what is not there, or lacks something; the text says where and what there is."""


@dataclass(frozen=True)
class Method:
    """An integrator, with a photon-query structure where it looks photons up; `name` as experiments write it."""

    name: str
    label: str
    integrator: str
    photon_map: str = ""
    plugins: tuple[str, ...] = ()
    eye_samples: int | None = None
    bias: str = NOT_SAID  # one of BIASES

    def apply(self, run: Run, scene: "Scene") -> Run:
        """The run with this method."""
        integrator = self.integrator.replace("{photons}", str(scene.photons))
        plugins = run.plugins + self.plugins
        return run.but(integrator=integrator, photon_map=self.photon_map, plugins=plugins, eye_samples=self.eye_samples)


@dataclass(frozen=True)
class Reference:
    """What a scene's images are compared with: an image that is there, or one to be rendered; `by`: the estimator.

    `error_image`: the image's standard error per pixel, where another program left one.
    """

    by: str
    image: str = ""
    error_image: str = ""
    run: Run | None = None
    independent: bool = True

    def source(self) -> "Run | str":
        """What Run.reference takes."""
        return self.run or self.image


@dataclass(frozen=True)
class Scene:
    """A scene as the experiments use it: its file, size, photons per pass, and reference."""

    name: str
    title: str
    file: str
    resolution: str
    photons: int
    crop: str
    settings: tuple[str, ...]
    plain: dict = field(hash=False, compare=False)
    full: bool = False

    def run(self, **changes) -> Run:
        """A run of this scene, still without a method."""
        kept = {"scene": self.file, "resolution": self.resolution, "crop": self.crop, "settings": self.settings}
        return Run(**{**kept, **changes})

    @property
    def reference(self) -> Reference:
        """What its images are compared with."""
        plain = dict(self.plain["reference"])
        if self.full:
            plain.update(plain.pop("full", {}))
        plain.pop("full", None)
        by, independent = plain.pop("by"), plain.pop("independent", True)
        if "image" in plain:
            return Reference(by, plain["image"], plain.get("error_image", ""), independent=independent)
        run = self.run(**{**plain, "integrator": plain["integrator"].replace("{photons}", str(self.photons))})
        return Reference(by, run=run, independent=independent)


@dataclass
class Catalogue:
    """Every method and scene that is declared."""

    integrators: dict[str, dict]
    structures: dict[str, dict]
    scenes: dict[str, Scene]

    @staticmethod
    def read(methods: Path, scenes: Path, full: bool) -> "Catalogue":
        """Read the two files; sizes of `full` scenes take the place of the small ones."""
        tables = read_toml(methods)
        _check_methods(methods, tables)
        found = {}
        for name, table in read_toml(scenes).items():
            plain = {**table, **(table.get("full", {}) if full else {})}
            try:
                found[name] = Scene(
                    name,
                    plain.get("title", name),
                    plain["file"],
                    plain["resolution"],
                    plain["photons"],
                    plain.get("crop", ""),
                    tuple(plain.get("settings", ())),
                    plain,
                    full,
                )
                assert plain["reference"]["by"]
            except KeyError as missing:
                raise DeclarationError(f"{scenes}: scene {name} lacks {missing}") from None
        return Catalogue(tables.get("integrators", {}), tables.get("structures", {}), found)

    def scene(self, name: str) -> Scene:
        """A scene by its name."""
        if name not in self.scenes:
            raise DeclarationError(f"no scene is called '{name}'; there are: {', '.join(self.scenes)}")
        return self.scenes[name]

    def method(self, name: str) -> Method:
        """A method by its name: INTEGRATOR or INTEGRATOR+STRUCTURE."""
        integrator, _, structure = name.partition("+")
        table = self._row(self.integrators, integrator, "integrator")
        plugins = [table["plugin"]] if "plugin" in table else []
        label, photon_map = table.get("label", integrator), ""
        if structure:
            if not table.get("structures"):
                raise DeclarationError(f"'{name}': {integrator} does not use a photon map")
            of_map = self._row(self.structures, structure, "structure")
            photon_map = of_map["use"]
            plugins += [of_map["plugin"]] if "plugin" in of_map else []
            label = f"{label}, {of_map.get('label', structure)}"
        bias = table.get("bias", NOT_SAID)
        return Method(name, label, table["use"], photon_map, tuple(plugins), table.get("eye_samples"), bias)

    def methods(self, names: list[str]) -> list[Method]:
        """Methods by their names; "*": every integrator, "NAME+*": every structure, "*+NAME": all that take one."""
        chosen: dict[str, Method] = {}
        for name in names:
            integrator, plus, structure = name.partition("+")
            takes = [one for one, table in self.integrators.items() if not plus or table.get("structures")]
            for first in takes if integrator == "*" else [integrator]:
                for second in self.structures if structure == "*" else [structure]:
                    full_name = f"{first}+{second}" if second else first
                    chosen.setdefault(full_name, self.method(full_name))
        return list(chosen.values())

    @staticmethod
    def _row(rows: dict, name: str, kind: str) -> dict:
        if name not in rows:
            raise DeclarationError(f"methods.toml has no {kind} '{name}'; there are: {', '.join(rows)}")
        return rows[name]


def _check_methods(path: Path, tables: dict) -> None:
    """Refuse what would be passed over in silence: an unknown table or key, a bias that is none of BIASES."""
    for kind, rows in tables.items():
        if kind not in _KEYS:
            raise DeclarationError(f"{path}: there is no table [{kind}]; tables are: {', '.join(_KEYS)}")
        for name, row in rows.items():
            where = f"{path}: [{kind}] {name}"
            if "use" not in row:
                raise DeclarationError(f"{where} lacks 'use'")
            for key in row:
                if key not in _KEYS[kind]:
                    raise DeclarationError(f"{where} has no key '{key}'; keys are: {', '.join(_KEYS[kind])}")
            if "bias" in row and row["bias"] not in BIASES[:-1]:
                said = ", ".join(f'"{one}"' for one in BIASES[:-1])
                raise DeclarationError(f"{where}: bias is one of {said}, not {row['bias']!r}")


def read_toml(path: Path) -> dict:
    """A declaration; what is wrong with it is said with its name."""
    try:
        return tomllib.loads(path.read_text())
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise DeclarationError(f"{path}: {error}") from None
