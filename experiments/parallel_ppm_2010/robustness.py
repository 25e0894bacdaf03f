"""Every method and stochastic PPM in equal time, where light takes specular-diffuse-specular paths."""

from pathlib import Path

from lab import equal_time
from lab.equal_time import Outcome
from lab.figures import downloads, draw, figure, palette
from lab.reports import judge, reference_text, write_csv
from lab.runs import Run
from lab.sections import Section, Verdict
from lab.store import Store
from lab.target import Plan
from parallel_ppm_2010.common import SOURCE

WORDS = ("relmse_trimmed", "flip")
ABOUT = 2.0  # times the list's error that one photon a bucket may have in equal time


def runs(plan: Plan) -> list[Run]:
    """Every scene under every method."""
    return [case.run(plan) for case in equal_time.cases(plan)]


def better_verdict(found: list[Outcome], methods: list[str], against: list[str], claim: str) -> Verdict:
    """Are all of `methods` nearer the reference than each of `against`, by both measures, on every scene?"""
    told, passed, why, keys = [], [], [], {}
    for scene in dict.fromkeys(one.case.scene.name for one in found):
        of_scene = [one for one in found if one.case.scene.name == scene]
        title = of_scene[0].case.scene.title
        for word in WORDS:
            of_word = []
            for other in against:
                pairs = equal_time.below(of_scene, methods, other, word)
                passed += [share < 1.0 for _, _, share in pairs]
                if pairs:
                    of_word.append(f"{spoken([share for _, _, share in pairs])} of {other}'s")
                why += [
                    f"{mine.case.method.label} has more {word} on {title} than {other}"
                    for mine, _, share in pairs
                    if share >= 1.0
                ]
                keys.update((one.key, None) for pair in pairs for one in pair[:2])
            if of_word:
                told.append(f"{title}, {word.replace('relmse_trimmed', 'trimmed relMSE')}: {', '.join(of_word)}")
    measured = f"Error as a share: {'; '.join(told)}" if told else "not measured"
    return Verdict(claim, measured, judge(passed), "; ".join(why), SOURCE, list(keys))


def spoken(shares: list[float]) -> str:
    """The smallest and largest of some ratios."""
    low, high = f"{min(shares):.2g}", f"{max(shares):.2g}"
    return low if low == high else f"{low} to {high}"


def list_verdict(found: list[Outcome], full: str, stochastic: str) -> Verdict:
    """Is one photon a bucket about as accurate as a list of all of them?"""
    pairs = equal_time.below(found, [stochastic], full, "relmse_trimmed")
    told = "; ".join(f"{mine.case.scene.title}: {share:.2g}" for mine, _, share in pairs)
    beyond = [mine.case.scene.title for mine, _, share in pairs if share > ABOUT]
    return Verdict(
        "In equal time stochastic PPM with one photon a bucket is about as accurate as with all photons",
        f"Its trimmed relMSE over that of the full list in equal time: {told}" if told else "not measured",
        judge(share <= ABOUT for _, _, share in pairs),
        f"A ratio up to {ABOUT:g} counts: the structure trades noise for speed"
        + (f"; it is more on {', '.join(beyond)}" if beyond else ""),
        SOURCE,
        [one.key for pair in pairs for one in pair[:2]],
    )


def report(plan: Plan, store: Store, folder: Path) -> Section:
    """Images of each scene, a table of errors, error against time, and verdicts."""
    found = equal_time.outcomes(plan, store, folder)
    rows, plots = equal_time.rows_of(found), equal_time.plots_of(plan, found)
    files = [write_csv(folder / "robustness.csv", rows)]
    if found:
        equal_time.draw_sheet(plan, store, folder, found, "robustness")
        files += downloads("robustness", "images")
    if plots:
        names = [series.method for plot in plots for series in plot.series]
        with figure(folder, "error", (2.6 * len(plots), 2.6), 1, len(plots)) as (drawn, axes):
            for one, plot in zip(axes.flat, plots, strict=True):
                draw(one, plot, palette(names))
            handles, labels = axes[0, 0].get_legend_handles_labels()
            drawn.legend(handles, labels, loc="outside upper center", ncols=len(labels), fontsize=6)
        files += downloads("error", "error against time")
    claim = "Progressive photon mapping renders specular-diffuse-specular light where path tracing fails"
    verdicts = [better_verdict(found, plan["progressive"], plan["against"], claim)]
    verdicts.append(list_verdict(found, *plan["list_and_stochastic"]))
    return Section(
        plan.name,
        plan["title"],
        plan.experiment,
        [
            f"{plan['time_s']} s of rendering for each method, set-up not counted. `ppm` keeps the hit points of its "
            "first pass, `sppm` draws new ones in every pass; `photon_map` traces its photons once: passes remove "
            "noise, not its blur.",
            *(reference_text(scene, store) for scene in plan.scenes if found),
        ],
        verdicts,
        plots,
        equal_time.viewers_of(plan, store, folder, found),
        [equal_time.table_of(rows)],
        files,
    )
