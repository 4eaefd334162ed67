"""What every page must keep: texts in their boxes, and contrast; and a browser to look at it, at its pace."""

import argparse
import pathlib
import shutil
import signal

WIDTHS = [800, 1280, 1920]
SCHEMES = ["light", "dark"]

# Texts that leave their box, their page or each other's place.
TEXTS = r"""
() => {
  const wrong = [];
  const shown = (element) => element.checkVisibility({ visibilityProperty: true }) && element.getClientRects().length;
  const named = (element) => `${element.tagName.toLowerCase()}.${element.getAttribute("class") || ""} "${element.textContent.trim().slice(0, 40)}"`;
  const own = (element) => [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
  const texts = [...document.querySelectorAll("body *")].filter((element) => own(element) && shown(element) && !element.closest("script, style, noscript, option"));
  for (const element of texts) {
    const scrolls = element.closest(".wide, pre");
    const box = element.getBoundingClientRect();
    if (!scrolls && (box.left < -1 || box.right > innerWidth + 1)) wrong.push(`${named(element)} leaves the page: ${box.left} to ${box.right}`);
    if (!(element instanceof SVGElement) && element.clientWidth && element.scrollWidth > element.clientWidth + 1) wrong.push(`${named(element)} leaves its box`);
    const size = parseFloat(getComputedStyle(element).fontSize);
    if (size < 11) wrong.push(`${named(element)} has ${size} px`);
  }
  if (document.documentElement.scrollWidth > innerWidth) wrong.push(`the page is ${document.documentElement.scrollWidth} px wide`);
  const apart = (elements, room, place) => {
    const boxes = elements.filter(shown).map((element) => [element, element.getBoundingClientRect()]);
    boxes.forEach(([element, box], index) => {
      if (box.left < room.left - 1 || box.right > room.right + 1 || box.top < room.top - 1 || box.bottom > room.bottom + 1) wrong.push(`${place}: ${named(element)} leaves its plot`);
      for (const [other, its] of boxes.slice(0, index)) {
        const [across, down] = [Math.min(box.right, its.right) - Math.max(box.left, its.left), Math.min(box.bottom, its.bottom) - Math.max(box.top, its.top)];
        if (across > 1 && down > 3) wrong.push(`${place}: ${named(element)} lies over ${named(other)}`);
      }
    });
  };
  for (const panel of document.querySelectorAll(".panel")) {
    const frame = panel.querySelector(".frame");
    const letters = [...frame.querySelectorAll(".xtick text, .ytick text, .shape-label text"), ...frame.querySelectorAll(".label span, .label b")];
    apart(letters, frame.getBoundingClientRect(), panel.querySelector("h3").textContent);
  }
  const track = document.querySelector("#track");
  if (!track) return wrong;
  apart([...track.querySelectorAll("span")], track.getBoundingClientRect(), "track");
  apart([...document.querySelectorAll(".controls > *, .controls .right > *")].filter((element) => !element.matches(".right") && element.textContent), document.querySelector(".controls").getBoundingClientRect(), "controls");
  return wrong;
}
"""

# Texts with less contrast than 4.5 to their ground.
CONTRAST = r"""
() => {
  const numbers = (color) => (color.match(/[\d.]+/g) || []).map(Number);
  const light = (color) => {
    const [r, g, b] = numbers(color).slice(0, 3).map((part) => part / 255).map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const color = getComputedStyle(at).backgroundColor;
      if (color.startsWith("rgb(")) return color;
    }
    return "rgb(255, 255, 255)";
  };
  const own = (element) => [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
  const wrong = [];
  for (const element of document.querySelectorAll("body *")) {
    if (!own(element) || !element.checkVisibility({ visibilityProperty: true }) || element.closest("script, style, noscript, option, :disabled")) continue;
    const style = getComputedStyle(element);
    const color = element instanceof SVGElement ? style.fill : style.color;
    const [a, b] = [light(color), light(ground(element))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) wrong.push(`"${element.textContent.trim().slice(0, 30)}" has a contrast of ${ratio.toFixed(2)}: ${color} on ${ground(element)}`);
  }
  return [...new Set(wrong)];
}
"""


# Milliseconds that three frames take, each counted as a second at most.
PACE = r"""
async () => {
  const began = performance.now();
  for (let frame = 0; frame < 3; frame++) {
    await Promise.race([new Promise(requestAnimationFrame), new Promise((done) => setTimeout(done, 1000))]);
  }
  return performance.now() - began;
}
"""
SLOWEST_PACE_MS = 2000
# Exit code of a script for such a browser.
SLOW = 3


class SlowBrowser(Exception):
    """A browser that draws about one frame a second, or none."""


def keep_pace(page):
    """Raises SlowBrowser where the browser of a page is one."""
    pace_ms = page.evaluate(PACE)
    if pace_ms > SLOWEST_PACE_MS:
        raise SlowBrowser(f"three frames in {pace_ms:.0f} ms")


def asked(limit_s, **what):
    """The arguments of a script: a browser, what it opens, and a folder for pictures. A browser that hangs ends the script after `limit_s`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("browser")
    for name, form in what.items():
        parser.add_argument(name, **form)
    parser.add_argument("--pictures", type=pathlib.Path)
    parser.add_argument("--must-keep-pace", action="store_true")
    options = parser.parse_args()
    signal.alarm(limit_s)
    if options.pictures:
        options.pictures.mkdir(parents=True, exist_ok=True)
    return options


def launched(playwright, browser):
    """That browser, without a sandbox and a graphics card."""
    return playwright.chromium.launch(executable_path=shutil.which(browser), args=["--no-sandbox", "--disable-gpu"])
