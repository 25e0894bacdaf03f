"""Reads the experiments' page as a person would, in a browser."""

import io

import numpy as np
from matplotlib.image import imread
from playwright.sync_api import expect

from support.page_sample import WIDTH


class Reader:
    """Hands and eyes on a viewer."""

    def __init__(self, page, key, images):
        self.page = page
        self.root = page.locator(f"#{key}")
        self.images = images
        self.stage = self.root.locator(".stage")
        self.stage.evaluate("stage => stage.scrollIntoView({ block: 'center' })")
        page.wait_for_timeout(500)  # a wheel that scrolls the page does not zoom
        self.settle()

    def settle(self):
        expect(self.root).to_have_attribute("aria-busy", "false")
        expect(self.root.locator(".message")).to_be_hidden()
        self.box = self.stage.bounding_box()
        return self

    def point(self, x, y):
        """Where the middle of a pixel is on the screen while the whole image is shown."""
        scale = self.box["width"] / WIDTH
        return self.box["x"] + (x + 0.5) * scale, self.box["y"] + (y + 0.5) * scale

    def hover(self, x, y):
        self.page.mouse.move(*self.point(x, y))

    def colour(self, x, y):
        """What is seen there: RGB, 0 to 255."""
        left, top = self.point(x, y)
        shot = self.page.screenshot(clip={"x": left, "y": top, "width": 1, "height": 1})
        return np.round(imread(io.BytesIO(shot))[0, 0, :3] * 255).astype(int)

    def pixel(self):
        """The pixel that is read out, and the numbers by the row's name."""
        words = self.root.locator(".pixel").inner_text().replace(",", "").split()
        return int(words[1]), int(words[2])

    def values(self, row):
        cells = self.root.locator(f"tr[data-row='{row}'] td")
        expect(cells.first).not_to_have_text("–")
        return [float(text.replace("−", "-")) for text in cells.all_inner_texts()]

    def press(self, key):
        self.page.keyboard.press(key)
        return self.settle()

    def click(self, name):
        self.root.get_by_role("button", name=name, exact=True).click()
        return self.settle()
