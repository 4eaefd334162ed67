"""Uses a console in a browser as its user would.

    python3 console.py BROWSER URL [--must-keep-pace] [--pictures FOLDER]

Prints one line for each thing that is wrong, and times. Ends with 1 where something is wrong, and with 3 where the browser must keep pace and does not.
"""

import http.client
import pathlib
import sys
import urllib.parse

from playwright.sync_api import sync_playwright

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "rig" / "tests" / "browser"))
from checks import CONTRAST, SCHEMES, SLOW, TEXTS, WIDTHS, SlowBrowser, asked, keep_pace, launched  # noqa: E402

# Time after which a browser that hangs ends the test, s.
LIMIT_S = 240
# A gamepad whose stick the test moves.
GAMEPAD = """
window.pad = { connected: true, axes: [0, 0, 0, 0], buttons: [{ pressed: false }, { pressed: false }] };
navigator.getGamepads = () => [window.pad];
"""


class Page:
    """A page of the console."""

    def __init__(self, browser, options, name, wrong):
        self.page, self.name, self.wrong = browser.new_page(viewport={"width": 1280, "height": 900}), name, wrong
        self.must_keep_pace = options.must_keep_pace
        self.page.set_default_timeout(60_000)
        self.page.add_init_script(GAMEPAD)
        self.page.on("console", lambda message: message.type in ("error", "warning") and self.complain(f"console: {message.text}"))
        self.page.on("pageerror", lambda error: self.complain(f"error: {error}"))
        self.page.goto(options.url)
        # A browser may draw a window behind another one less often.
        self.page.bring_to_front()
        self.keep_pace()
        self.until("ready", "yes")

    def keep_pace(self):
        if self.must_keep_pace and not self.page.is_closed():
            keep_pace(self.page)

    def complain(self, text):
        self.wrong.append(f"{self.name}: {text}")

    def expect(self, is_right, text):
        if not is_right:
            self.complain(text)

    def until(self, key, value, patience_ms=60_000):
        self.page.wait_for_selector(f"html[data-{key}='{value}']", state="attached", timeout=patience_ms)

    def data(self, key):
        return self.page.evaluate("(key) => document.documentElement.dataset[key]", key)

    def tip_mm(self):
        return [float(word) for word in self.page.inner_text("#tip").split() if word.lstrip("-").isdigit()]

    def text(self, id):
        return self.page.inner_text(f"#{id}")

    def see(self, text, id):
        self.page.wait_for_selector(f"#{id}:has-text('{text}')")

    def looks(self, pictures, what):
        """Texts at every width, in both schemes; pictures of all of them."""
        for scheme in SCHEMES:
            self.page.emulate_media(color_scheme=scheme)
            for width in WIDTHS:
                self.page.set_viewport_size({"width": width, "height": 900})
                self.keep_pace()
                self.page.wait_for_timeout(150)
                for text in self.page.evaluate(TEXTS):
                    self.complain(f"{width} px, {scheme}: {text}")
                if pictures:
                    self.page.screenshot(path=pictures / f"console-{what}-{width}-{scheme}.png", full_page=True)
            for text in self.page.evaluate(CONTRAST):
                self.complain(f"{scheme}: {text}")
        self.page.emulate_media(color_scheme="light")
        self.page.set_viewport_size({"width": 1280, "height": 900})


def status(url, **headers):
    """Code of an answer."""
    place = urllib.parse.urlsplit(url)
    connection = http.client.HTTPConnection(place.netloc)
    connection.request("GET", place.path, headers=headers)
    return connection.getresponse().status


def strangers(browser, url, wrong):
    """Who does not know the token, or comes from elsewhere, gets nothing."""
    place = urllib.parse.urlsplit(url)
    socket = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA=="}
    asked = [
        ("another token", f"http://{place.netloc}/0123456789abcdef0123456789abcdef/", {}, 404),
        ("no token", f"http://{place.netloc}/", {}, 404),
        ("another host", url, {"Host": f"softlimb.example:{place.port}"}, 403),
        ("a socket without an origin", url + "socket", socket, 403),
        ("a socket of another origin", url + "socket", {**socket, "Origin": "http://softlimb.example"}, 403),
        ("the report before there is one", url + "report", {}, 404),
    ]
    for what, address, headers, expected in asked:
        found = status(address, **headers)
        if found != expected:
            wrong.append(f"{what}: {found} in place of {expected}")
    page = browser.new_page()
    page.goto("data:text/html,elsewhere")
    address = url.replace("http", "ws") + "socket"
    opened = page.evaluate("(address) => new Promise((done) => { const socket = new WebSocket(address); socket.onopen = () => done(true); socket.onerror = () => done(false); })", address)
    if opened:
        wrong.append("a page from elsewhere opens the socket")
    page.close()


def by_hand(first, second):
    """Keys, buttons, sliders and a gamepad move the limb until they are let go."""
    page = first.page
    page.click("#arm")
    first.until("session", "live")
    second.until("session", "live")
    first.see("tip x", "tip")
    second.expect(page.is_enabled("#task") and second.page.is_disabled("#task"), "a page that looks may run the task")
    second.expect("another" in second.text("role"), second.text("role"))
    page.locator("h1").click()

    def moved(how, let_go, what, axis=None):
        first.keep_pace()
        before = first.tip_mm()
        how()
        first.until("moving", "true")
        page.wait_for_timeout(700)
        let_go()
        first.until("moving", "false", 5_000)
        page.wait_for_timeout(500)
        after = first.tip_mm()
        way = [b - a for a, b in zip(before, after)]
        far = max(abs(part) for part in way) if axis is None else way[axis]
        first.expect(far > 2.0, f"{what} moves the tip by {way} mm")

    moved(lambda: page.keyboard.down("w"), lambda: page.keyboard.up("w"), "the key w", 0)
    moved(lambda: page.keyboard.down("a"), lambda: page.evaluate("window.dispatchEvent(new Event('blur'))"), "the key a until the focus is lost", 1)
    page.keyboard.up("a")
    slider = page.locator("#moves input").first
    box = slider.bounding_box()
    middle = box["y"] + 0.5 * box["height"]

    def drag():
        page.mouse.move(box["x"] + 0.5 * box["width"], middle)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.8 * box["width"], middle, steps=4)

    moved(drag, page.mouse.up, "the slider of x", 0)
    first.expect(slider.input_value() == "0", "the slider does not spring back")
    slider.focus()
    moved(lambda: page.keyboard.down("ArrowLeft"), lambda: page.keyboard.up("ArrowLeft"), "an arrow key on the slider")
    page.locator("#moves button").nth(1).focus()
    moved(lambda: page.keyboard.down("Enter"), lambda: page.keyboard.up("Enter"), "Enter on a button", 0)
    page.locator("h1").click()
    moved(lambda: page.evaluate("window.pad.axes[1] = -0.8"), lambda: page.evaluate("window.pad.axes[1] = 0"), "the gamepad", 0)
    # A page that hangs while a key is down lets go.
    page.keyboard.down("s")
    first.until("moving", "true")
    page.evaluate("() => { const end = performance.now() + 1000; while (performance.now() < end); }")
    page.keyboard.up("s")
    second.until("moving", "false", 5_000)
    # One step a press.
    first.keep_pace()
    page.check("#steps")
    before = first.tip_mm()
    page.locator("h1").click()
    page.keyboard.press("w")
    page.wait_for_timeout(1500)
    first.expect(2.0 < first.tip_mm()[0] - before[0] < 9.0, f"a step of 5 mm moves the tip from {before} to {first.tip_mm()}")
    page.uncheck("#steps")
    page.locator("h1").click()
    delays = []
    for _ in range(100):
        taken = first.data("taken")
        page.evaluate("document.getElementById('hold').click()")
        page.wait_for_selector(f"html:not([data-taken='{taken}'])", state="attached")
        delays.append(float(first.data("delay")))
    delays.sort()
    updates = int(first.data("updates"))
    page.wait_for_timeout(2000)
    rate = (int(first.data("updates")) - updates) / 2
    print(f"page to server and back, ms: p50 {delays[49]:.1f}, p99 {delays[98]:.1f}; {rate:.0f} updates a second")


def task(first, second):
    """The task begins at rest, is held, goes on, and is vented by a page that only looks."""
    page = first.page
    page.click("#task")
    first.see("vent first", "refusal")
    page.keyboard.press("Escape")
    first.until("session", "vented")
    page.click("#resume")
    first.until("session", "live")
    page.click("#task")
    first.see("Task:", "progress")
    page.wait_for_timeout(1500)
    page.click("#hold")
    first.see("held", "progress")
    first.expect(page.locator("#moves input").first.is_disabled(), "a held task is moved by hand")
    page.click("#task")
    page.wait_for_selector("#progress:not(:has-text('held'))")
    page.wait_for_timeout(1000)
    second.page.click("#vent")
    first.until("session", "vented")


def fault(first):
    """A part breaks on purpose: the device stops, and the report is there."""
    page = first.page
    page.click("#resume")
    first.until("session", "live")
    page.select_option("#fault", "sensor-zero")
    page.locator("h1").click()
    page.keyboard.down("w")
    page.wait_for_timeout(500)
    page.click("#break button")
    first.until("session", "idle")
    page.keyboard.up("w")
    first.expect("fault" in first.text("message").lower(), f"message: {first.text('message')}")
    after = first.text("after")
    first.expect(after.startswith("The device ") and "Arm starts a new session" in after, f"after the stop: {after}")
    first.see("(fault)", "strips")
    faults = first.text("faults").lower()
    first.expect("on purpose" in faults and "none" not in faults, f"faults after the stop: {faults}")
    with page.expect_popup() as opened:
        page.click("#report")
    report = opened.value
    problems = []
    report.on("console", lambda message: message.type == "error" and problems.append(message.text))
    report.on("pageerror", lambda error: problems.append(str(error)))
    report.reload()
    report.wait_for_selector("html[data-ready]", state="attached", timeout=120_000)
    first.expect("on purpose" in report.content(), "the report does not tell the fault on purpose")
    first.expect(not problems, f"report: {problems}")
    report.close()


def alone(browser, url, first, second, wrong):
    """Without a page that commands the limb holds, and is vented later."""
    first.page.click("#arm")
    first.until("session", "live")
    first.page.locator("h1").click()
    first.page.keyboard.down("w")
    first.until("moving", "true")
    first.page.close()
    second.until("moving", "false", 5_000)
    second.see("no page commands", "role")
    second.until("session", "vented", 15_000)
    second.page.click("#take")
    second.until("commands", "true")
    second.page.click("#end")
    second.until("session", "idle")


def use(browser, options, pages, wrong):
    """All of it, with two pages."""
    strangers(browser, options.url, wrong)
    pages += [Page(browser, options, name, wrong) for name in ("first page", "second page")]
    first, second = pages
    first.page.bring_to_front()
    first.until("commands", "true")
    first.expect(not first.page.is_visible("#report"), "a report before there is one")
    second.until("commands", "false")
    by_hand(first, second)
    first.looks(options.pictures, "live")
    first.keep_pace()
    task(first, second)
    first.keep_pace()
    fault(first)
    first.looks(options.pictures, "idle")
    alone(browser, options.url, first, second, wrong)


def main():
    options = asked(LIMIT_S, url={})
    wrong = []
    with sync_playwright() as playwright:
        browser = launched(playwright, options.browser)
        pages = []
        try:
            use(browser, options, pages, wrong)
        except SlowBrowser as slow:
            print(slow)
            sys.exit(SLOW)
        except Exception as error:  # what was found before is told all the same
            wrong.append(f"{type(error).__name__}: {error}")
        try:
            # A slow browser is the cause of whatever came too late.
            for page in pages if wrong else []:
                page.keep_pace()
        except SlowBrowser as slow:
            print("\n".join([str(slow), *wrong]))
            sys.exit(SLOW)
        browser.close()
    print("\n".join(wrong))
    sys.exit(bool(wrong))


main()
