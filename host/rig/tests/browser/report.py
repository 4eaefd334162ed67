"""Opens a report in a browser and uses it as a reader would.

    python3 report.py BROWSER PAGE [--must-keep-pace] [--pictures FOLDER]

Prints one line for each thing that is wrong, and figures of the updates. Ends with 1 where something is wrong, and with 3
where the browser must keep pace and does not.
"""

import pathlib
import re
import sys

from checks import CONTRAST, SCHEMES, SLOW, TEXTS, WIDTHS, SlowBrowser, asked, keep_pace, launched
from playwright.sync_api import sync_playwright

# Time after which a browser that hangs ends the test, s.
LIMIT_S = 240
# Milliseconds of script in an update, over the whole run; and from frame to frame while the slider moves, for ten seconds at most: a browser on
# busy cores may draw one frame a second.
UPDATES = r"""
async () => {
  const { rows, show } = window.report;
  const spent = [];
  for (let update = 0; update < 300; update++) {
    const row = Math.floor(update * (rows - 1) / 299);
    const began = performance.now();
    show(row);
    spent.push(performance.now() - began);
  }
  const slider = document.querySelector("#slider");
  const frames = [];
  const began = performance.now();
  let last = began;
  for (let update = 0; update < 300 && last < began + 10_000; update++) {
    slider.value = Math.floor(update * (rows - 1) / 299);
    slider.dispatchEvent(new Event("input"));
    await Promise.race([new Promise(requestAnimationFrame), new Promise((done) => setTimeout(done, 1000))]);
    const now = performance.now();
    frames.push(now - last);
    last = now;
  }
  const of = (list, share) => [...list].sort((a, b) => a - b)[Math.floor(share * (list.length - 1))].toFixed(1);
  return { rows, script: [of(spent, 0.5), of(spent, 0.95)], frame: [of(frames, 0.5), of(frames, 0.95)] };
}
"""


class Reader:
    """A reader with one open page."""

    def __init__(self, page, name, must_keep_pace):
        self.page, self.name, self.must_keep_pace, self.wrong = page, name, must_keep_pace, []
        page.on("console", lambda message: message.type in ("error", "warning") and self.complain(f"console: {message.text}"))
        page.on("pageerror", lambda error: self.complain(f"error: {error}"))
        page.on("request", lambda request: request.url.startswith(("file:", "data:", "blob:")) or self.complain(f"request: {request.url}"))

    def complain(self, text):
        self.wrong.append(f"{self.name}: {text}")

    def expect(self, is_right, text):
        if not is_right:
            self.complain(text)

    def begins(self, step):
        """The last step that is named is the one in which a browser hangs."""
        print(f"{self.name}: {step}", file=sys.stderr, flush=True)

    def open(self, file):
        self.page.goto(file.resolve().as_uri())
        # A browser may draw a window behind another one less often.
        self.page.bring_to_front()
        self.keep_pace()
        self.until("document.documentElement.dataset.ready === 'plots'", timeout=120_000)

    def until(self, condition, **options):
        """Waits for a condition. It is tried ten times a second, not with each frame: a slow browser draws few."""
        self.page.wait_for_function(condition, polling=100, **options)

    def keep_pace(self):
        if self.must_keep_pace:
            keep_pace(self.page)

    def row(self):
        return int(self.page.locator("#space").get_attribute("data-row"))

    def until_row(self, condition):
        self.until(f"(() => {{ const row = Number(document.querySelector('#space').dataset.row); return {condition}; }})()", timeout=60_000)

    def picture(self):
        return self.page.evaluate("document.querySelector('#space').toDataURL()")

    def move_slider(self, row):
        self.page.locator("#slider").evaluate("(slider, row) => { slider.value = row; slider.dispatchEvent(new Event('input')); }", row)
        self.until_row(f"row === {row}")

    def slider_moves_the_limb(self):
        rows = self.page.evaluate("window.report.rows")
        seen = []
        for row in (0, rows // 3, 2 * rows // 3):
            self.move_slider(row)
            cursor = self.page.locator(".panel .cursor").first.evaluate("(cursor) => cursor.style.transform")
            value = self.page.locator(".panel .label b").first.text_content()
            seen.append((self.picture(), cursor, self.page.locator("#now").text_content()))
            self.expect(re.fullmatch(r"-?\d+\.\d+|–", value), f"value at the cursor: {value}")
        for kind, of_kind in zip(("limb", "cursor", "time"), zip(*seen)):
            self.expect(len(set(of_kind)) == 3, f"the {kind} does not follow the slider")
        self.move_slider(0)
        self.expect(self.picture() == seen[0][0], "the same time gives another picture")
        self.solids_have_names()

    def solids_have_names(self):
        space = self.page.evaluate("JSON.parse(document.querySelector('#run').textContent).space")
        names = [one["name"] for one in space["solids"] + space["carried"]]
        shown = self.page.evaluate("window.report.view.named")
        self.expect(set(names) <= {one["name"] for one in shown}, f"names in space: {shown}, of {names}")
        # The walls of the box hide its bottom, and show an edge each.
        hidden = [one["name"] for one in shown if one.get("hidden")]
        self.expect(hidden == [name for name in names if name == "box-bottom"], f"names with a ring: {hidden}")
        for index, one in enumerate(shown):
            over = [other["name"] for other in shown[:index] if abs(one["x"] - other["x"]) < one["half"] + other["half"] and abs(one["y"] - other["y"]) < 12]
            self.expect(not over, f"the name {one['name']} lies over {over}")

    def hover_shows_values(self):
        panel = self.page.locator(".panel").first
        panel.scroll_into_view_if_needed()
        box = panel.locator(".plot").bounding_box()
        self.page.mouse.move(box["x"] + 0.5 * box["width"] - 1, box["y"] + 0.5 * box["height"])
        self.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        legend = panel.locator(".hoverlayer .legendtext")
        legend.first.wait_for(timeout=10_000)
        texts = legend.all_text_contents()
        names = panel.locator(".label span").all_text_contents()
        self.expect(any(name in text for name in names for text in texts), f"hover names no line: {texts}")
        self.expect(any(re.search(r"\d+\.\d+", text) for text in texts), f"hover has no value: {texts}")
        self.page.mouse.move(5, 5)

    def keyboard_works(self):
        page = self.page
        page.locator("h1").click()
        page.keyboard.press("Home")
        self.until_row("row === 0")
        page.keyboard.press("ArrowRight")
        self.until_row("row === 1")
        page.keyboard.press("Shift+ArrowRight")
        self.until_row("row > 20")
        page.keyboard.press("End")
        last = self.page.evaluate("window.report.rows") - 1
        self.until_row(f"row === {last}")
        page.keyboard.press("ArrowLeft")
        self.until_row(f"row === {last - 1}")
        page.keyboard.press("Home")
        self.until_row("row === 0")
        page.keyboard.press(" ")
        self.until_row("row > 10")
        page.keyboard.press(" ")
        self.until("document.querySelector('#play').textContent === 'Play'")
        whole = page.evaluate("[...window.report.plots.range]")
        page.keyboard.press("+")
        self.expect_one_range(lambda low, high: high - low < 0.6 * (whole[1] - whole[0]), "plus does not zoom")
        page.keyboard.press("0")
        self.expect_one_range(lambda low, high: [low, high] == whole, "0 does not show the whole run")
        before = self.picture()
        page.locator("#space").focus()
        row = self.row()
        page.keyboard.press("ArrowLeft")
        self.until("(before) => document.querySelector('#space').toDataURL() !== before", arg=before)
        self.expect(self.row() == row, "turning the view moves the time")
        # Tab reaches what a mouse reaches.
        page.locator("#play").focus()
        page.keyboard.press("Enter")
        self.until("document.querySelector('#play').textContent === 'Pause'")
        page.keyboard.press("Enter")
        self.until("document.querySelector('#play').textContent === 'Play'")

    def drag_zooms_all(self):
        plot = self.page.locator(".panel .plot").first
        plot.scroll_into_view_if_needed()
        box = plot.bounding_box()
        height = box["y"] + 0.5 * box["height"]
        self.page.mouse.move(box["x"] + 0.3 * box["width"], height)
        self.page.mouse.down()
        self.page.mouse.move(box["x"] + 0.5 * box["width"], height, steps=5)
        self.page.mouse.up()
        whole = self.page.evaluate("window.report.plots.whole")
        self.until("document.body.classList.contains('zoomed')", timeout=10_000)
        self.expect_one_range(lambda low, high: 0 < high - low < 0.5 * (whole[1] - whole[0]), "a drag does not zoom")
        self.page.locator("#whole").click()
        self.expect_one_range(lambda low, high: [low, high] == whole, "the button does not show the whole run")

    def expect_one_range(self, is_right, text):
        ranges = self.page.evaluate(
            "[window.report.plots.range, ...window.report.plots.panels.filter((panel) => panel.drawn && panel.shown).map((panel) => panel.plot._fullLayout.xaxis.range)]"
        )
        self.expect(len({tuple(round(end, 6) for end in one) for one in ranges}) == 1, f"plots show unequal times: {ranges}")
        self.expect(is_right(*ranges[0]), f"{text}: {ranges[0]}")

    def looks(self, pictures):
        """Texts at every width, in both schemes; pictures of all of them."""
        for scheme in SCHEMES:
            self.page.emulate_media(color_scheme=scheme)
            for width in WIDTHS:
                self.page.set_viewport_size({"width": width, "height": 900})
                self.keep_pace()
                self.all_plots()
                at = f"{width} px, {scheme}"
                for text in self.page.evaluate(TEXTS):
                    self.complain(f"{at}: {text}")
                if pictures:
                    self.page.screenshot(path=pictures / f"{self.name}-{width}-{scheme}-top.png")
                    self.page.screenshot(path=pictures / f"{self.name}-{width}-{scheme}.png", full_page=True)
            for text in self.page.evaluate(CONTRAST):
                self.complain(f"{scheme}: {text}")
        self.page.emulate_media(color_scheme="light")

    def all_plots(self):
        """Plots are drawn where they are seen: scrolls past all of them."""
        self.page.evaluate("""async () => {
            const next = () => Promise.race([new Promise(requestAnimationFrame), new Promise((done) => setTimeout(done, 200))]);
            const frame = () => next().then(() => new Promise((done) => setTimeout(done, 30)));
            const current = () => report.plots.panels.every(({ drawn, stale, plot, frame }) => drawn && !stale && plot._fullLayout.width === report.plots.width(frame));
            for (let round = 0; round < 5 && !(round && current()); round++) {
                for (let y = 0; y < document.body.scrollHeight; y += innerHeight / 2) { scrollTo(0, y); await frame(); }
            }
            scrollTo(0, 0);
            await frame();
        }""")
        drawn = self.page.evaluate("[report.plots.panels.length, document.querySelectorAll('.panel .main-svg').length > 0, report.plots.panels.every((panel) => panel.drawn)]")
        self.expect(drawn[0] >= 4 and all(drawn[1:]), f"plots: {drawn}")

    def print(self, pictures):
        """On paper all plots are light, and none is cut off."""
        self.page.emulate_media(color_scheme="dark")
        self.page.evaluate("window.onbeforeprint_state = null; addEventListener('beforeprint', () => { window.at_print = report.plots.panels.map((panel) => [panel.plot._fullLayout.width, panel.plot._fullLayout.font.color]); })")
        paper = self.page.pdf(format="A4", print_background=True, margin={side: "10mm" for side in ("top", "right", "bottom", "left")})
        if pictures:
            (pictures / f"{self.name}.pdf").write_bytes(paper)
        at_print = self.page.evaluate("window.at_print")
        self.expect(at_print and all(width <= 340 and color.upper() == "#1B1F24" for width, color in at_print), f"plots on paper: {at_print}")
        self.page.emulate_media(color_scheme="light")


def read(page, file, pictures, must_keep_pace):
    """Uses one report; a line for each thing that is wrong with it. A browser that must keep pace and does not raises SlowBrowser."""
    page.set_default_timeout(60_000)
    reader = Reader(page, file.stem, must_keep_pace)
    try:
        reader.open(file)
        for step in (reader.slider_moves_the_limb, reader.hover_shows_values, reader.keyboard_works, reader.drag_zooms_all):
            reader.keep_pace()
            reader.begins(step.__name__)
            step()
        reader.begins("looks")
        reader.looks(pictures)
        reader.begins("print")
        reader.print(pictures)
        reader.keep_pace()
        reader.begins("updates")
        figures = page.evaluate(UPDATES)
        print(f"{file.stem}: {file.stat().st_size} bytes, {figures['rows']} rows; ms, median and 95 %: script {figures['script']}, frame {figures['frame']}")
    except SlowBrowser:
        raise
    except Exception as error:  # the remaining pages are opened all the same
        # A slow browser is the cause of whatever came too late.
        reader.keep_pace()
        reader.complain(f"{type(error).__name__}: {error}")
    return reader.wrong


def main():
    options = asked(LIMIT_S, page={"type": pathlib.Path})
    with sync_playwright() as playwright:
        browser = launched(playwright, options.browser)
        page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme="light")
        try:
            wrong = read(page, options.page, options.pictures, options.must_keep_pace)
        except SlowBrowser as slow:
            print(slow)
            sys.exit(SLOW)
        browser.close()
    print("\n".join(wrong))
    sys.exit(bool(wrong))


main()
