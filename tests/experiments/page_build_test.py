"""The page of the experiments as files: what is rewritten, what is an error, and number formats."""

import pytest
from lab.page import PageError, build_page, significant
from lab.sections import Image, Section, Viewer

from support.page_sample import MACHINE, made_up_images, make_reproduction, rgb, section_files, write_exr


def test_building_again_rewrites_only_what_changed(tmp_path):
    folder, images = tmp_path, made_up_images()
    make_reproduction(folder, images)
    scripts = lambda: {file.name: file.stat().st_mtime_ns for file in (folder / "page/images").iterdir()}  # noqa: E731
    before = scripts()
    assert len(before) == 6  # four images, two maps
    write_exr(folder / "runs/ppm/image.exr", rgb(images["ppm"] * 2))
    build_page(folder, section_files(folder), MACHINE)
    after = scripts()
    assert len(after) == 6
    assert len(before.keys() - after.keys()) == 1
    assert all(after[name] == before[name] for name in before.keys() & after.keys())


def test_what_no_page_can_be_made_of(tmp_path):
    section = Section("lost", "Lost", "effects", viewers=[Viewer("v", "V", [Image("a", "a", "nowhere.exr", "")])])
    section.write(tmp_path)
    with pytest.raises(PageError, match="section 'lost', viewer 'v', image 'a': there is no file .*nowhere.exr"):
        build_page(tmp_path, [tmp_path / "section.json"], {})
    (tmp_path / "section.json").write_text('{"schema": "other/1"}')
    with pytest.raises(PageError, match="its schema is 'other/1'"):
        build_page(tmp_path, [tmp_path / "section.json"], {})


def test_numbers_for_tables():
    shown = {
        "1230": 1234.0,
        "12\u202f300": 12345.0,
        "100\u202f000": 99999.6,
        "1.00": 1.0,
        "−0.500": -0.5,
        "1.23e−5": 0.000012345,
        "1.00e7": 1e7,
        "0": 0,
        "12\u202f345\u202f678": 12345678,
        "yes": True,
        "–": None,
        "1, 2.50": [1, 2.5],
    }
    assert [significant(value) for value in shown.values()] == list(shown)
