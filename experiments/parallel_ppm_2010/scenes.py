"""Box, Cognac, Pool and Kitchen: their triangles beside the paper's, and pictures."""

import json
import subprocess
from dataclasses import replace
from pathlib import Path

from lab.figures import downloads, figure
from lab.images import Gallery, read_exr
from lab.reports import show_picture, what_failed
from lab.runs import ROOT, Run
from lab.sections import Column, Download, Section, Table, Verdict, Viewer
from lab.store import Store
from lab.target import Plan
from parallel_ppm_2010.common import SOURCE, with_parameters

NEAR = 0.05  # share by which a count may differ from the paper's


def picture_runs(plan: Plan) -> dict[str, Run]:
    """The run of each scene's picture."""
    made = {}
    for scene in plan.scenes:
        sized = replace(scene, photons=plan["photons"])
        budget = {"resolution": plan["resolution"], "passes": plan["passes"][scene.name]}
        run = plan.run(sized, plan.methods[0], plan.backends[0], **budget)
        made[scene.name] = run.but(integrator=with_parameters(run.integrator, alpha=plan["alpha"]))
    return made


def runs(plan: Plan) -> list[Run]:
    """A picture of each scene."""
    return list(picture_runs(plan).values()) if plan.backends else []


def described(program: Path, scene: str) -> dict:
    """What `lampyris describe` says of a scene."""
    words = [str(program), "describe", scene, "--json"]
    return json.loads(subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout)


def verdict_of(rows: list[dict]) -> Verdict:
    """Whether the counts are the paper's."""
    near = [abs(row["triangles"] / row["paper"] - 1.0) <= NEAR for row in rows]
    return Verdict(
        claim="; ".join(f"{row['scene']}: {row['paper'] // 1000}k triangles" for row in rows),
        measured="; ".join(f"{row['scene']}: {row['triangles']:,} triangles" for row in rows),
        holds="yes" if near and all(near) else "partly" if any(near) else "no" if near else "not tested",
        why=f"A count holds within {NEAR:.0%}. The scenes are built anew: what they show and their sizes are like "
        "the paper's, their meshes are not the same.",
        source=SOURCE,
        runs=[key for row in rows for key in row["runs"]],
    )


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Counts, a contact sheet, and each picture to look at."""
    made = picture_runs(plan) if plan.backends else {}
    gallery = Gallery(store, folder)
    rows, viewers, shown, data = [], [], [], {}
    for scene in plan.scenes:
        data[scene.name] = told = described(store.machine.program, scene.file)
        run = made.get(scene.name)
        record = store.record(run) if run else {}
        statistics = record.get("statistics", {})
        rows.append(
            {
                "scene": scene.title,
                "triangles": told["triangles_with_instances"],
                "paper": plan["paper_triangles"].get(scene.name),
                "materials": told["materials"],
                "passes": statistics.get("passes"),
                "photons": statistics.get("photons_emitted"),
                "seconds": statistics.get("wall_s"),
                "error": statistics.get("estimated_error"),
                "told": what_failed(record),
                "runs": [store.key(run)] if run else [],
            }
        )
        if statistics:
            shown.append((scene.title, read_exr(store.image(run))))
            image = gallery.of_run(scene.title, plan.methods[0].name, run)
            viewers.append(Viewer(scene.name, scene.title, [image]))
    files = [Download("scenes.json", "what `lampyris describe` says of the scenes (JSON)")]
    (folder / "scenes.json").write_text(json.dumps(data, indent=1) + "\n")
    if shown:
        with figure(
            folder, "scenes", (7.0, 7.0 * 0.75 * ((len(shown) + 1) // 2) / 2 + 0.3), (len(shown) + 1) // 2, 2
        ) as (
            _,
            axes,
        ):
            for one in axes.flat:
                one.set_axis_off()
            for one, (title, image) in zip(axes.flat, shown, strict=False):
                show_picture(one, image, title)
        files += downloads("scenes", "the four pictures")
    columns = [
        Column("scene", "scene"),
        Column("triangles", "triangles here"),
        Column("paper", "triangles in the paper"),
        Column("materials", "materials"),
        Column("passes", "passes"),
        Column("photons", "photons emitted"),
        Column("seconds", "rendering", "s"),
        Column("error", "estimated relMSE", "", 2),
        Column("told", "remarks"),
    ]
    caption = (
        "Triangles are what `lampyris describe` counts. The estimated relMSE is the program's own, of noise and bias."
    )
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        text=[
            "Four scenes after those of the paper. In Box, Cognac and Kitchen every lamp is behind glass, in Pool "
            "the sun's light on the tiles comes and goes through water: nearly all light of the pictures arrives "
            "over caustics.",
            f"Rendered by `{plan.methods[0].name}` at {plan['resolution']}.",
        ],
        verdicts=[verdict_of([row for row in rows if row["paper"]])],
        viewers=viewers,
        tables=[Table("triangles", "Scenes", columns, rows, caption)],
        downloads=files,
    )
