"""Scenes of strangers: what they may read and write. tests/cli/faults_test.py has more of what is refused."""

import os
import resource
import struct
import subprocess
import zlib

import pytest

from support.render_program import SCENE, run

SECRET = "a secret of somebody else"


def limited_to_2_gib():
    resource.setrlimit(resource.RLIMIT_DATA, (2 << 30, 2 << 30))


@pytest.fixture
def folders(tmp_path):
    """A scene in one folder that needs a file of another."""
    for name in ("scene", "shared", "other"):
        (tmp_path / name).mkdir()
    (tmp_path / "shared/sphere.pbrt").write_text('Shape "sphere" "float radius" 0.3\n')
    (tmp_path / "scene/scene.pbrt").write_text(SCENE + 'Include "../shared/sphere.pbrt"\n')
    return tmp_path


def render(program, *arguments, **options):
    return run(program, *arguments, "-o", "o.pfm", "--resolution", "8x8", "--spp", "1", "-q", **options)


@pytest.mark.parametrize(
    "before, after, allowed",
    [
        ([], [], ""),
        (["--allow", "other"], [], ""),
        (["--allow", "shared"], [], None),
        ([], ["--allow", "shared"], None),
        (["--allow", "other", "--allow", "shared"], [], None),
        ([], ["--allow", "other:shared/"], None),
        ([], [], "shared"),
        ([], [], "other:shared"),
    ],
)
def test_folders_are_allowed(program, folders, before, after, allowed):
    """`allowed`: the environment's; "": none, and the scene is refused."""
    environment = {**os.environ, **({"LAMPYRIS_ALLOW": allowed} if allowed else {})}
    done = render(program, *before, "scene/scene.pbrt", *after, cwd=folders, env=environment)
    assert done.returncode == (1 if allowed == "" else 0), done.stderr
    assert (folders / "o.pfm").exists() == (allowed != "")


def test_a_folder_that_does_not_exist_is_not_allowed(program, folders):
    done = render(program, "scene/scene.pbrt", "--allow", "none", cwd=folders)
    assert done.returncode == 1
    assert "--allow" in done.stderr and "none" in done.stderr


def test_describe_has_the_same_rule(program, folders):
    for more, code in (([], 1), (["--allow", "shared"], 0)):
        command = [str(program), "describe", "scene/scene.pbrt", *more]
        done = subprocess.run(command, cwd=folders, capture_output=True, text=True, check=False, timeout=60)
        assert done.returncode == code, done.stderr


@pytest.mark.parametrize("link", [False, True])
def test_a_message_shows_nothing_of_a_file_elsewhere(program, folders, link):
    (folders / "other/secret").write_text(SECRET)
    name = "../other/secret"
    if link:
        (folders / "scene/link").symlink_to(folders / "other/secret")
        name = "link"
    statements = [
        f'Include "{name}"',
        f'Import "{name}"',
        f'Shape "plymesh" "string filename" "{name}"',
        f'Texture "t" "spectrum" "imagemap" "string filename" "{name}"',
        f'LightSource "infinite" "string filename" "{name}"',
        f'LightSource "projection" "string filename" "{name}"',
        f'LightSource "goniometric" "string filename" "{name}"',
        f'Material "diffuse" "string normalmap" "{name}"',
        f'Material "conductor" "spectrum eta" "{name}"',
        f'AreaLightSource "diffuse" "string filename" "{name}" Shape "sphere"',
    ]
    for statement in statements:
        (folders / "scene/scene.pbrt").write_text(SCENE + statement + ' Shape "sphere"\n')
        done = render(program, "scene/scene.pbrt", cwd=folders)
        assert done.returncode == 1, statement
        assert "outside of the scene's folder" in done.stderr, statement
        assert SECRET not in done.stderr


@pytest.mark.parametrize("name", ["../o.pfm", "/tmp/lampyris-stranger.pfm", "link.pfm", "folder/o.pfm"])
def test_a_scene_does_not_choose_what_is_overwritten(program, folders, name):
    here = folders / "scene"
    (folders / "other/older.pfm").write_text("older")
    (here / "link.pfm").symlink_to(folders / "other/older.pfm")
    (here / "folder").symlink_to(folders / "other")
    (here / "scene.pbrt").write_text(SCENE.replace("named.exr", name))
    done = run(program, "scene.pbrt", "-q", cwd=here)
    assert done.returncode == 1
    assert "outside of the working folder" in done.stderr
    assert (folders / "other/older.pfm").read_text() == "older"
    assert sorted(path.name for path in (folders / "other").iterdir()) == ["older.pfm"]
    assert run(program, "scene.pbrt", "-q", "-o", "mine.pfm", cwd=here).returncode == 0


@pytest.mark.parametrize("where", ["name", "type", "texture", "file", "accelerator", "light"])
@pytest.mark.parametrize("evil", ["\x1b]0;title\x07\x1b[31m", "\u009b31m", "a\u202eb", "a\0b", "a\U000e0041b"])
def test_control_characters_are_shown_as_escapes(program, scene, where, evil):
    text = {
        "accelerator": f'WorldBegin Accelerator "{evil}" Shape "none"',
        "light": f'LightSource "{evil}"',
        "name": f'Material "{evil}"',
        "type": f'Shape "{evil}"',
        "texture": f'Material "diffuse" "texture reflectance" "{evil}" Shape "sphere"',
        "file": f'Include "{evil}"',
    }[where]
    scene.write_text(SCENE + text + '\nShape "last"\n')
    done = render(program, scene, cwd=scene.parent)
    assert done.returncode == 1
    assert not set("\x1b\x07\u009b\u202e\0\U000e0041") & set(done.stderr)
    # Nothing cuts what is said.
    assert 'unknown shape "last"' in done.stderr or where == "accelerator"


def test_a_long_name_is_cut(program, scene):
    scene.write_text(SCENE + 'Shape "' + "long" * 1000000 + '"\n')
    done = render(program, scene, cwd=scene.parent)
    assert done.returncode == 1 and "unknown shape" in done.stderr
    assert len(done.stderr) < 10000


def test_a_transform_that_overflows_is_no_motion(program, scene):
    scene.write_text(SCENE + "Scale 10 10 10\n" * 400 + 'Shape "sphere"\n')
    done = render(program, scene, cwd=scene.parent)
    assert done.returncode == 1 and "cannot be inverted" in done.stderr
    assert "motion blur" not in done.stderr


@pytest.mark.parametrize("way", ["link/there/../../scene/in.pbrt", "link/not_there/../../scene/in.pbrt"])
def test_a_link_does_not_tell_what_is_elsewhere(program, folders, way):
    (folders / "other/there").mkdir()
    (folders / "scene/in.pbrt").write_text('Shape "sphere"\n')
    (folders / "scene/link").symlink_to(folders / "other")
    (folders / "scene/scene.pbrt").write_text(SCENE + f'Include "{way}"\n')
    done = render(program, "scene/scene.pbrt", cwd=folders)
    assert done.returncode == 1 and "outside of the scene's folder" in done.stderr


def test_nor_do_options_and_file_names_reach_the_terminal(program, tmp_path):
    name = "\x1b[31mred.pbrt"
    (tmp_path / name).write_text(SCENE)
    for more in ([], ["--integrator", "\x1b[31m"], ["--backend", "\x1b[31m"], ["--set", "\x1b=1"], ["-o", "\x1b.gif"]):
        done = run(program, name, *more, "--spp", "1", cwd=tmp_path)
        assert "\x1b" not in done.stderr + done.stdout, more
        assert "\\x1b" in done.stderr + done.stdout


def test_a_picture_that_becomes_large_is_refused(program, scene, tmp_path):
    """12000 x 12000 pixels of black in 420 kB."""
    rows = zlib.compress(bytes((12000 * 3 + 1) * 12000), 9)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", 12000, 12000, 8, 2, 0, 0, 0)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")
    (tmp_path / "large.png").write_bytes(png)
    scene.write_text(
        SCENE
        + 'Texture "t" "spectrum" "imagemap" "string filename" "large.png"\n'
        + 'Material "diffuse" "texture reflectance" "t" Shape "sphere"\n'
    )
    done = render(program, scene, "--max-memory", "512M", cwd=tmp_path, preexec_fn=limited_to_2_gib)
    assert done.returncode == 2
    assert "--max-memory" in done.stderr and "12000x12000" in done.stderr


def test_our_own_scenes_keep_to_their_folders(source_dir):
    listed = subprocess.run(
        ["git", "ls-files", "scenes", "experiments", "examples"],
        cwd=source_dir,
        capture_output=True,
        text=True,
        check=True,
    )
    scenes = [source_dir / name for name in listed.stdout.split() if name.endswith(".pbrt")]
    assert len(scenes) > 50
    leaving = [str(scene) for scene in scenes if '"../' in scene.read_text() or '"/' in scene.read_text()]
    assert leaving == []
