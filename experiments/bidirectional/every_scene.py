"""Every method in equal time on scenes of all kinds: what paths from both ends, their merging and mutations gain."""

from pathlib import Path

from lab import equal_time
from lab.equal_time import Outcome
from lab.figures import downloads
from lab.reports import judge, reference_text, write_csv
from lab.runs import Run
from lab.sections import Column, Section, Table, Verdict
from lab.store import Store
from lab.target import Plan

NAME = "every-scene"
WORD = "relmse_trimmed"
ABOUT = 2.0  # times the error of the better of its two halves that vcm may have
WORDS = {"relmse": "relMSE", WORD: "relMSE, trimmed"}
CAPTIONS = {
    "relmse": "Of the whole picture: a few pixels that rare bright paths hit may be most of it.",
    WORD: "Without the 0.1 % of pixels that are worst.",
}


def runs(plan: Plan) -> list[Run]:
    """Every scene under every method."""
    return [case.run(plan) for case in equal_time.cases(plan)]


def scene_rows(found: list[Outcome], word: str) -> list[dict]:
    """A row for each scene and backend: the error of every method, and whose is the least."""
    rows = []
    for name, backend in dict.fromkeys((one.case.scene.name, one.case.backend) for one in found):
        of_scene = [one for one in found if (one.case.scene.name, one.case.backend) == (name, backend)]
        errors = {one.case.method: one.error(word) for one in of_scene}
        known = {method: error for method, error in errors.items() if error is not None}
        row = {"scene": of_scene[0].case.scene.title, "backend": backend}
        row |= {method.name: error for method, error in errors.items()}
        row["least"] = min(known, key=known.get).label if known else ""
        rows.append({**row, "runs": [one.key for one in of_scene]})
    return rows


def table_of(plan: Plan, found: list[Outcome], word: str) -> Table:
    """Scenes below each other, methods beside each other."""
    columns = [Column("scene", "scene"), *([Column("backend", "backend")] if len(plan.backends) > 1 else [])]
    columns += [Column(method.name, method.label) for method in plan.methods]
    columns.append(Column("least", "least"))
    return Table(word, f"{WORDS[word]} in equal time", columns, scene_rows(found, word), CAPTIONS[word])


def hidden_verdict(found: list[Outcome], hidden: list[str]) -> Verdict:
    """Is bidirectional path tracing the better path tracing where lamps are hidden?"""
    of_hidden = [one for one in found if one.case.scene.name in hidden]
    pairs = equal_time.below(of_hidden, ["bdpt"], "path", WORD)
    told = "; ".join(f"{mine.case.scene.title}: {share:.2g}" for mine, _, share in pairs)
    worse = [mine.case.scene.title for mine, _, share in pairs if share >= 1.0]
    return Verdict(
        "Where lamps are hidden, bidirectional path tracing has less error than path tracing in equal time",
        f"Its trimmed relMSE over that of path tracing: {told}" if told else "not measured",
        judge(share < 1.0 for _, _, share in pairs),
        f"it has more on {', '.join(worse)}" if worse else "",
        "Lafortune and Willems, Bi-directional Path Tracing (1993)",
        [one.key for pair in pairs for one in pair[:2]],
    )


def robust_verdict(found: list[Outcome]) -> Verdict:
    """Is merging and connecting nowhere much worse than the better of the two?"""
    to_bdpt = {mine.key: (mine, other, share) for mine, other, share in equal_time.below(found, ["vcm"], "bdpt", WORD)}
    told, passed, keys = [], [], []
    why = f"A ratio up to {ABOUT:g} counts: it does the work of both"
    for mine, merged, share in equal_time.below(found, ["vcm"], "sppm", WORD):
        if mine.key not in to_bdpt:
            continue
        _, connected, other_share = to_bdpt[mine.key]
        title, most = mine.case.scene.title, max(share, other_share)
        told.append(f"{title}: {most:.2g}")
        passed.append(most <= ABOUT)
        why += f"; it is more on {title}" if most > ABOUT else ""
        keys += [mine.key, connected.key, merged.key]
    return Verdict(
        "Connecting and merging (VCM) is robust: about as good as the better of bidirectional path tracing and SPPM",
        f"Its trimmed relMSE over that of the better one: {'; '.join(told)}" if told else "not measured",
        judge(passed),
        why,
        "Georgiev et al., Light Transport Simulation with Vertex Connection and Merging (2012)",
        keys,
    )


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Tables of errors, images of each scene, error against time, and verdicts."""
    found = equal_time.outcomes(plan, store, folder)
    files = [write_csv(folder / f"{NAME}.csv", equal_time.rows_of(found))]
    if found:
        equal_time.draw_sheet(plan, store, folder, found, NAME)
        files += downloads(NAME, "images")
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        [
            f"{plan['time_s']} s of rendering for each method, set-up not counted. Small pictures: a pass of `mlt` or "
            "`vcm` is a large part of the time.",
            "`maxdepth` bounds a path; of `sppm`, `ppm` and `photon_map` the eye's path and the photon's, each: where "
            "it cuts light off, they show more of it.",
            *(reference_text(scene, store) for scene in plan.scenes if found),
        ],
        [hidden_verdict(found, plan["hidden"]), robust_verdict(found)],
        equal_time.plots_of(plan, found),
        equal_time.viewers_of(plan, store, folder, found),
        [table_of(plan, found, word) for word in WORDS],
        files,
    )
