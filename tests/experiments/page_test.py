"""The page of the experiments, made from a small synthetic reproduction and read in Chromium with real clicks."""

import shutil

import numpy as np
import pytest
from playwright.sync_api import expect, sync_playwright

from support.page_reader import Reader
from support.page_sample import HEIGHT, NAN_PIXEL, TEXT, WIDTH, made_up_images, make_reproduction

PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True, "device_scale_factor": 2}


@pytest.fixture(scope="session")
def images():
    return made_up_images()


@pytest.fixture(scope="session")
def reproduction(images, tmp_path_factory):
    folder = tmp_path_factory.mktemp("reproduce")
    make_reproduction(folder, images)
    return folder


@pytest.fixture(scope="session")
def browser():
    program = shutil.which("chromium")
    assert program, "chromium is not there: `./dev test` installs it (packages.txt, group test)"
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def complaints():
    """Messages of the browser about the page, and its network requests: there must be none."""
    return []


@pytest.fixture(autouse=True)
def without_complaints(complaints):
    yield
    assert complaints == []


@pytest.fixture(scope="session")
def open_page(browser, reproduction, complaints):
    def opener(**options):
        page = browser.new_context(**{"viewport": {"width": 1280, "height": 800}, **options}).new_page()
        page.set_default_timeout(8000)
        page.on("console", lambda message: message.type in ("error", "warning") and complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "request",
            lambda asked: asked.url.startswith(("file:", "data:", "blob:")) or complaints.append(asked.url),
        )
        page.goto((reproduction / "index.html").as_uri())
        return page

    return opener


@pytest.fixture(scope="session")
def laptop(open_page):
    """The page on a laptop, light; one for all tests, for loading it takes seconds."""
    return open_page(color_scheme="light")


@pytest.fixture
def viewer(laptop, images):
    """A viewer in its initial state."""
    reader = Reader(laptop, "effects-images-whole", images)
    reader.hover(5, 5)
    reader.press("f").press("Digit1").click("Image")
    if reader.root.get_by_role("button", name="A/B").get_attribute("aria-pressed") == "true":
        reader.press("s")
    reader.root.get_by_label("Exposure in stops").fill("0")
    reader.stage.focus()
    return reader.settle()


def half(images, name, x=30, y=12):
    """A pixel as the page has it: rounded to half floats."""
    return images[name][y, x].astype(np.float16).astype(float)


def srgb(linear):
    linear = np.asarray(linear, dtype=float)
    return np.round(
        255 * np.clip(np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055), 0, 1)
    )


def test_pixel_values_and_display(viewer, images):
    viewer.hover(30, 12)
    assert viewer.pixel() == (30, 12)
    for row, name in (("A", "path"), ("B", "ppm"), ("Reference", "reference")):
        if row == "B":
            viewer.press("Shift+Digit2")
            viewer.hover(20, 50)
            viewer.hover(30, 12)
        assert viewer.values(row) == pytest.approx(half(images, name), rel=1e-4)  # 5 digits are shown
    viewer.press("s")
    assert viewer.colour(30, 12) == pytest.approx(srgb(half(images, "path")), abs=1)
    viewer.press("e").press("e")  # two halves of a stop
    assert viewer.colour(30, 12) == pytest.approx(srgb(2 * half(images, "path")), abs=1)
    expect(viewer.root.get_by_role("button", name="+1 EV")).to_be_visible()
    viewer.press("E")
    expect(viewer.root.get_by_role("button", name="+0.5 EV")).to_be_visible()
    viewer.root.get_by_label("Exposure in stops").fill("-2")
    viewer.settle()
    assert viewer.colour(30, 12) == pytest.approx(srgb(half(images, "path") / 4), abs=1)


def test_pixels_that_are_no_numbers(viewer):
    assert list(viewer.colour(*NAN_PIXEL)) == [255, 0, 255]
    viewer.hover(*NAN_PIXEL)
    assert np.isnan(viewer.values("A")).tolist() == [False, True, False]
    viewer.press("Digit3")
    viewer.hover(10, 10)
    assert viewer.values("A, reference") == [65504] * 3  # clamped to the largest half
    viewer.press("Digit1")
    viewer.click("Relative error")
    assert list(viewer.colour(*NAN_PIXEL)) == [255, 0, 255]


def test_pan_zoom_and_the_linked_viewer(viewer):
    page = viewer.page
    viewer.hover(24, 16)
    page.mouse.wheel(0, -480)  # 4 times larger, about the pointer
    assert viewer.pixel() == (24, 16)
    x, y = viewer.point(24, 16)
    scale = 4 * viewer.box["width"] / WIDTH
    page.mouse.move(x + 5 * scale, y)
    assert viewer.pixel() == (29, 16)
    page.mouse.down()
    page.mouse.move(x - 2 * scale, y + 3 * scale, steps=4)
    page.mouse.up()
    page.mouse.move(x - 2 * scale, y + 3 * scale + 0.1)
    assert viewer.pixel() == (29, 16)  # the image went with the mouse
    page.mouse.move(x, y)
    assert viewer.pixel() == (31, 13)

    linked = Reader(page, "effects-images-again", viewer.images)
    page.mouse.move(*linked.point(24, 16))
    assert linked.pixel() == (31, 13)
    expect(viewer.root.locator(".pixel")).to_contain_text("Pixel 31, 13")
    page.mouse.dblclick(*linked.point(24, 16))
    page.mouse.move(*linked.point(25, 16))
    assert linked.pixel() == (25, 16)
    page.keyboard.press("e")
    expect(viewer.root.get_by_role("button", name="+0.5 EV")).to_have_count(1)
    Reader(page, "effects-images-whole", viewer.images).hover(25, 17)
    assert viewer.pixel() == (25, 17)


def test_flip_by_keys_and_tabs(viewer, images):
    viewer.hover(30, 12)
    shown = viewer.root.get_by_role("tab", selected=True)
    for key, name in (
        ("Digit2", "ppm"),
        ("ArrowRight", "reference"),
        ("ArrowRight", "path"),
        ("ArrowLeft", "reference"),
    ):
        viewer.press(key)
        expect(shown).to_contain_text(name)
        assert viewer.colour(30, 12) == pytest.approx(srgb(half(images, name)), abs=1)
    viewer.root.get_by_role("tab").nth(1).click()
    viewer.settle()
    expect(shown).to_contain_text("ppm")
    expect(viewer.root.locator(".command code")).to_have_text(
        "lampyris render scenes/box.lamp --integrator ppm:photons=100000 --time 10 --seed 7 -o ppm.exr"
    )
    viewer.root.get_by_role("button", name="Copy the command").click()
    expect(viewer.root.get_by_role("button", name="Copy the command")).not_to_have_text("Copy")


def test_slider_between_two_images(viewer, images):
    viewer.click("A/B")
    viewer.root.get_by_label("Image B", exact=True).select_option(label="ppm")
    viewer.settle()
    divider = viewer.root.get_by_role("slider", name="Divider")
    for column in (48, 66, 24):
        box = divider.bounding_box()
        viewer.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 20)
        viewer.page.mouse.down()
        viewer.page.mouse.move(viewer.point(column, 0)[0], box["y"] + 30, steps=3)
        viewer.page.mouse.up()
        red, green, _ = viewer.colour(column - 4, 50)
        assert red > green + 100
        red, green, _ = viewer.colour(column + 4, 50)
        assert green > red + 100
    divider.press("ArrowRight")
    assert int(divider.get_attribute("aria-valuenow")) == pytest.approx(100 * 24.5 / WIDTH + 2, abs=1)


def test_error_maps(viewer, images):
    viewer.click("Relative error")
    viewer.hover(30, 12)
    image, reference = (half(images, name) for name in ("path", "reference"))
    expected = np.mean((image - reference) ** 2 / (reference**2 + 0.01))
    shown = viewer.root.locator(".pixel").inner_text().split("Relative error")[1]
    assert float(shown) == pytest.approx(expected, rel=1e-3)
    viewer.click("Difference")
    viewer.hover(31, 12)
    viewer.hover(30, 12)
    shown = viewer.root.locator(".pixel").inner_text().split("Difference")[1].replace("−", "-")
    assert float(shown) == pytest.approx(np.mean(image - reference), rel=1e-3)
    viewer.click("FLIP")
    viewer.hover(WIDTH - 1, HEIGHT - 1)
    assert viewer.root.locator(".pixel").inner_text().endswith("FLIP 1")
    assert list(viewer.colour(WIDTH - 1, HEIGHT - 1)) == [252, 253, 191]  # magma's last colour
    viewer.press("Digit2")
    flip = viewer.root.get_by_role("button", name="FLIP", exact=True)
    expect(flip).to_be_disabled()
    expect(flip).to_have_attribute("title", "No FLIP map was made of ppm")

    crop = Reader(viewer.page, "effects-images-crop", images)
    crop.click("Relative error")
    crop.hover(20, 10)
    assert crop.pixel() == (20, 10)  # its pixels are those of the whole picture
    assert crop.values("A") == pytest.approx(half(images, "path", 20, 10), rel=1e-4)
    assert crop.root.locator(".pixel").inner_text().endswith("Relative error 1")
    crop.press("m")
    expect(crop.root.get_by_role("button", name="Difference")).to_have_attribute("aria-pressed", "true")


def test_plots(laptop):
    page = laptop
    plot = page.locator("#accuracy-convergence-error .plot-area")
    plot.scroll_into_view_if_needed()
    point = plot.locator(".scatterlayer .points path").nth(1)
    box = point.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    hover = plot.locator(".hoverlayer")
    for text in ("path tracing", "seed=7, passes=4, backend=cpu", "a <tag>", "& b"):
        expect(hover).to_contain_text(text)
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    panel = page.locator(".panel")
    expect(panel).to_contain_text("k1")
    expect(panel.locator("code")).to_have_text("lampyris render 'a scene.lamp'")
    expect(panel).to_contain_text("seed")
    assert "xxx" not in panel.inner_text()
    page.keyboard.press("Escape")
    expect(panel).to_be_hidden()

    before = plot.evaluate("area => area.layout.xaxis.range.slice()")
    frame = plot.locator(".nsewdrag").bounding_box()
    page.mouse.move(frame["x"] + frame["width"] * 0.3, frame["y"] + frame["height"] * 0.3)
    page.mouse.down()
    page.mouse.move(frame["x"] + frame["width"] * 0.7, frame["y"] + frame["height"] * 0.8, steps=5)
    page.mouse.up()
    page.wait_for_function(
        "([area, low]) => area.layout.xaxis.range[0] > low + 0.1", arg=[plot.element_handle(), before[0]]
    )
    buttons = plot.locator(".modebar-btn").evaluate_all("all => all.map(one => one.dataset.title)")
    assert "Zoom in" in buttons
    assert not [title for title in buttons if "hare" in title]  # none would upload the data

    page.locator("#accuracy-convergence-time").scroll_into_view_if_needed()
    expect(page.locator("#accuracy-convergence-time .barlayer .point")).to_have_count(4)
    colours = page.locator("#accuracy-convergence-error .legendlines path").evaluate_all(
        "all => all.map(one => one.style.stroke)"
    )
    assert len(set(colours)) == 3


def test_tables_and_runs(laptop):
    page = laptop
    table = page.locator("#accuracy-convergence-summary")
    column = lambda index: table.locator(f"tbody td:nth-child({index})").all_inner_texts()  # noqa: E731
    assert column(2) == ["0.0123", "0.500", "–", "0.00200"]
    assert column(3)[0] == "1\u202f000\u202f000"
    table.get_by_role("button", name="relMSE").click()
    assert column(1) == ["bdpt", "path", "ppm", "sppm"]
    table.get_by_role("button", name="relMSE").click()
    assert column(1) == ["ppm", "path", "bdpt", "sppm"]
    table.get_by_role("button", name="Method").click()
    assert column(1) == ["bdpt", "path", "ppm", "sppm"]
    table.get_by_role("button", name="1 run").click()
    expect(page.locator(".panel")).to_contain_text("k0")
    page.locator(".panel").get_by_role("button", name="Close").click()
    page.locator(".verdict").first.get_by_role("button", name="2 runs").click()
    expect(page.locator(".panel h5")).to_have_text(["k0", "k1"])
    page.keyboard.press("Escape")


def test_text_theme_and_contents(laptop, tmp_path):
    page = laptop
    expect(page.locator("article p").first).to_have_text(TEXT.replace("`", ""))
    expect(page.locator(".mark")).to_have_count(8)
    assert (page.locator(".downloads a").get_attribute("href")) == "accuracy/convergence/data.csv"
    expect(page.locator(".machine")).to_contain_text("llvmpipe")
    plot = page.locator("#accuracy-convergence-error .plot-area")
    plot.scroll_into_view_if_needed()
    expect(plot.locator(".xtitle")).to_be_visible()
    inks = {}
    for name in ("light", "dark"):
        ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
        inks[name] = (ground, plot.locator(".xtitle").evaluate("title => title.style.fill"))
        page.get_by_role("button", name="Switch between light and dark").click()
    assert inks["light"][0] == "rgb(251, 251, 250)"
    assert inks["dark"][0] == "rgb(21, 23, 26)"
    assert inks["light"][1] != inks["dark"][1]
    page.locator(".contents").get_by_role("link", name="Images at equal time").click()
    expect(page.locator("#effects-images")).to_be_in_viewport()
    page.screenshot(path=tmp_path / "laptop.png")
    assert no_overflow(page)


def no_overflow(page):
    return page.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth")


def test_phone(open_page, images, tmp_path):
    page = open_page(**PHONE, color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(21, 23, 26)"
    contents = page.locator(".contents")
    expect(contents.get_by_role("link", name="Error over time")).to_be_hidden()
    contents.locator("summary").tap()
    contents.get_by_role("link", name="Images at equal time").tap()
    expect(contents.get_by_role("link", name="Error over time")).to_be_hidden()
    viewer = Reader(page, "effects-images-whole", images)
    page.touchscreen.tap(*viewer.point(30, 12))
    assert viewer.pixel() == (30, 12)
    assert viewer.values("A") == pytest.approx(half(images, "path"), rel=1e-4)

    # Two fingers, twice as far apart at the end as at the beginning, about the middle.
    touch = page.context.new_cdp_session(page)
    middle = (viewer.box["x"] + viewer.box["width"] / 2, viewer.box["y"] + viewer.box["height"] / 2)
    moves = [("touchMove", apart) for apart in (55, 70, 80)]
    for kind, apart in [("touchStart", 40), *moves, ("touchEnd", None)]:
        points = [{"x": middle[0] + sign * apart, "y": middle[1], "id": sign + 1} for sign in (-1, 1)] if apart else []
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    page.touchscreen.tap(*viewer.point(WIDTH / 2 + 20, HEIGHT / 2 + 10))
    assert viewer.pixel() == pytest.approx((WIDTH / 2 + 10, HEIGHT / 2 + 5), abs=1)
    page.screenshot(path=tmp_path / "phone.png")
    for anchor in ("accuracy-convergence", "accuracy-convergence-summary", "machine"):
        page.locator(f"#{anchor}").scroll_into_view_if_needed()
        assert no_overflow(page), anchor
    page.screenshot(path=tmp_path / "phone-end.png")


@pytest.mark.parametrize("screen", [{}, PHONE], ids=["laptop", "phone"])
def test_the_page_begins_with_its_answer_and_tabs_end_within_their_box(open_page, tmp_path, screen):
    page = open_page(**screen)
    answer = page.locator("#accuracy-convergence-answer")
    expect(answer).to_be_in_viewport()
    assert answer.bounding_box()["y"] < page.locator(".glance").bounding_box()["y"]
    expect(answer.locator("td").nth(1)).to_have_text("SPPM = path tracing: 0.21\N{NO-BREAK SPACE}s")
    page.get_by_role("link", name="LaTeX").first.wait_for()
    assert page.locator("a.latex").first.get_attribute("href") == "accuracy/convergence/answer.tex"
    if not screen:
        assert answer.locator(".table-scroll").evaluate("box => box.scrollWidth <= box.clientWidth")
    tabs = page.locator("#effects-images-many .tabs")
    tabs.scroll_into_view_if_needed()
    edges = (
        "list => [...list.children].map(tab => tab.getBoundingClientRect().right - list.getBoundingClientRect().right)"
    )
    assert max(tabs.evaluate(edges)) <= 0
    assert tabs.evaluate("list => list.scrollWidth <= list.clientWidth")
    assert tabs.bounding_box()["height"] <= 0.31 * page.viewport_size["height"]
    # An image that is chosen by a key is scrolled into view.
    page.locator("#effects-images-many .stage").focus()
    for _ in range(13):
        page.keyboard.press("ArrowRight")
    last = tabs.get_by_role("tab").last
    expect(last).to_have_attribute("aria-selected", "true")
    expect(last).to_be_in_viewport()
    page.screenshot(path=tmp_path / "many.png")
    assert no_overflow(page)
    page.context.close()
