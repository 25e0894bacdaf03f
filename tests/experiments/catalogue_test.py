"""Declarations: wildcards, references, sizes of --full, and what is said of wrong ones."""

import pytest
from lab.catalogue import EXPERIMENTS, Catalogue, DeclarationError
from lab.runs import ROOT
from lab.target import all_targets, with_references


@pytest.fixture
def catalogue():
    return Catalogue.read(EXPERIMENTS / "methods.toml", EXPERIMENTS / "scenes.toml", full=False)


def names(methods):
    return [one.name for one in methods]


def test_wildcards_name_what_is_declared(catalogue):
    assert names(catalogue.methods(["*"])) == list(catalogue.integrators)
    every = names(catalogue.methods(["sppm+*"]))
    assert every == [f"sppm+{one}" for one in catalogue.structures]
    takes = [name for name, table in catalogue.integrators.items() if table.get("structures")]
    assert names(catalogue.methods(["*+kd_tree"])) == [f"{one}+kd_tree" for one in takes]
    assert names(catalogue.methods(["sppm", "*", "sppm"]))[0] == "sppm"
    assert len(catalogue.methods(["sppm", "*", "sppm"])) == len(catalogue.integrators)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("frobnicate", "no integrator 'frobnicate'; there are: path"),
        ("sppm+frobnicate", "no structure 'frobnicate'; there are: stochastic_hash"),
        ("path+kd_tree", "does not use a photon map"),
    ],
)
def test_a_wrong_method_is_told(catalogue, name, said):
    with pytest.raises(DeclarationError, match=said):
        catalogue.methods([name])


def test_a_method_puts_the_scenes_photons_into_its_parameters(catalogue):
    scene = catalogue.scene("sds-lamp")
    run = catalogue.method("sppm+stochastic_hash_4").apply(scene.run(passes=1), scene)
    assert run.integrator == f"sppm:photonsperiteration={scene.photons}"
    assert run.photon_map == "stochastic_hash:slots=4"


def test_every_scene_and_its_reference_are_there(catalogue):
    for scene in catalogue.scenes.values():
        assert (ROOT / scene.file).is_file()
        reference = scene.reference
        assert reference.run or (ROOT / reference.image).is_file()
        assert not reference.error_image or (ROOT / reference.error_image).is_file()


def test_a_reference_is_made_before_what_is_compared_with_it(catalogue):
    scene = catalogue.scene("box")
    run = scene.run(integrator="path", spp=1, reference=scene.reference.source())
    assert with_references([run, run]) == [scene.reference.run, run]


def test_full_sizes_take_the_place_of_small_ones():
    full = Catalogue.read(EXPERIMENTS / "methods.toml", EXPERIMENTS / "scenes.toml", full=True)
    assert full.scene("box").resolution == "640x480"
    assert full.scene("box").reference.run.resolution == "640x480"


def test_every_target_plans_its_runs(catalogue):
    targets = all_targets()
    assert len({one.name for one in targets}) == len(targets)  # a name alone says which
    for target in targets:
        for full in (False, True):
            runs = target.module().runs(target.plan(catalogue, ["cpu", "vulkan"], "", full, {}))
            assert runs, target.id


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            '[integrators]\nmine = { use = "mine", bias = "some" }',
            'bias is one of "none", "vanishes", "stays", not \'some\'',
        ),
        ('[integrators]\nmine = { use = "mine", biased = true }', "mine has no key 'biased'; keys are: use, plugin"),
        ('[integrators]\nmine = { label = "mine" }', "mine lacks 'use'"),
        ('[structures]\nmine = { use = "mine", bias = "none" }', "has no key 'bias'"),
        ('[integrator]\nmine = { use = "mine" }', r"no table \[integrator\]"),
    ],
)
def test_what_methods_toml_does_not_know_is_refused(tmp_path, text, said):
    path = tmp_path / "methods.toml"
    path.write_text(text + "\n")
    with pytest.raises(DeclarationError, match=said):
        Catalogue.read(path, EXPERIMENTS / "scenes.toml", full=False)


def test_every_method_tells_its_bias(catalogue):
    assert all(table.get("bias") for table in catalogue.integrators.values())
