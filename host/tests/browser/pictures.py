"""Looks at pictures and sheets in a browser.

    python3 pictures.py BROWSER FILE... [--pictures FOLDER]

Prints one line for each text that lies over another, leaves its picture, is too small at 800 px or too pale. Ends with 1 where there is one.
"""

import pathlib
import sys

from playwright.sync_api import sync_playwright

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "rig" / "tests" / "browser"))
from checks import CONTRAST, SCHEMES, WIDTHS, asked, launched  # noqa: E402

# Time after which a browser that hangs ends the test, s.
LIMIT_S = 900
# Texts of drawings, in the units of the screen.
TEXTS = r"""
() => {
  const wrong = [];
  const drawings = document.documentElement.matches("svg") ? [document.documentElement] : [...document.querySelectorAll("body svg")];
  // A chart in a sheet cuts what leaves it.
  const chart = (text) => {
    const its = text.ownerSVGElement, [{ x, y, width, height }, matrix] = [its.viewBox.baseVal, its.getScreenCTM()];
    const [from, to] = [new DOMPoint(x, y), new DOMPoint(x + width, y + height)].map((corner) => corner.matrixTransform(matrix));
    return { left: from.x, top: from.y, right: to.x, bottom: to.y };
  };
  const leaves = (box, room) => box.left < room.left - 1 || box.right > room.right + 1 || box.top < room.top - 1 || box.bottom > room.bottom + 1;
  for (const drawing of drawings) {
    const room = drawing.getBoundingClientRect();
    if (room.width > innerWidth + 1) wrong.push(`a drawing is ${room.width} px wide`);
    const boxes = [...drawing.querySelectorAll("text")].map((text) => [text, text.getBoundingClientRect()]).filter(([, box]) => box.width);
    boxes.forEach(([text, box], index) => {
      const named = `"${text.textContent.trim().slice(0, 40)}"`;
      if (leaves(box, room) || leaves(box, chart(text))) wrong.push(`${named} leaves its drawing`);
      const size = parseFloat(getComputedStyle(text).fontSize) * text.getScreenCTM().a || parseFloat(getComputedStyle(text).fontSize) * Math.abs(text.getScreenCTM().b);
      if (size < 10.95) wrong.push(`${named} has ${size.toFixed(1)} px`);
      for (const [other, its] of boxes.slice(0, index)) {
        const [across, down] = [Math.min(box.right, its.right) - Math.max(box.left, its.left), Math.min(box.bottom, its.bottom) - Math.max(box.top, its.top)];
        if (across > 1 && down > 4) wrong.push(`${named} lies over "${other.textContent.trim().slice(0, 40)}"`);
      }
      // A name beside a mark covers none. Its box is higher than its letters.
      if (text.matches(".note")) for (const mark of text.ownerSVGElement.querySelectorAll("circle.line, .crosses, .squares")) {
        const its = mark.getBoundingClientRect();
        const [across, down] = [Math.min(box.right, its.right) - Math.max(box.left, its.left), Math.min(box.bottom - 3, its.bottom) - Math.max(box.top + 3, its.top)];
        if (across > 1 && down > 1) wrong.push(`${named} covers a mark`);
      }
    });
  }
  return wrong;
}
"""
# The ground of a drawing that stands by itself is its first rectangle: texts have no parent with a color.
INK = CONTRAST.replace('document.querySelectorAll("body *")', 'document.querySelectorAll("text")').replace(
    "const ground = (element) => {", 'const ground = (element) => { const page = document.querySelector("rect.page"); if (page) return getComputedStyle(page).fill;'
)


def main():
    options = asked(LIMIT_S, files={"nargs": "+", "type": pathlib.Path})
    wrong = []
    with sync_playwright() as playwright:
        browser = launched(playwright, options.browser)
        page = browser.new_page(viewport={"width": WIDTHS[0], "height": 900})
        page.set_default_timeout(60_000)
        for file in options.files:
            page.goto(file.resolve().as_uri())
            for scheme in SCHEMES:
                page.emulate_media(color_scheme=scheme)
                for width in WIDTHS:
                    page.set_viewport_size({"width": width, "height": 900})
                    wrong += [f"{file.name}, {width} px, {scheme}: {text}" for text in page.evaluate(TEXTS)]
                    if options.pictures:
                        drawing = page.evaluate("[document.documentElement.scrollHeight, document.documentElement.getBoundingClientRect().height]")
                        page.set_viewport_size({"width": width, "height": min(6000, max(900, int(max(drawing)) + 1))})
                        page.screenshot(path=options.pictures / f"{file.stem}-{width}-{scheme}.png")
                wrong += [f"{file.name}, {scheme}: {text}" for text in page.evaluate(INK)]
        browser.close()
    print("\n".join(wrong))
    sys.exit(bool(wrong))


main()
