"""A person in front of the page: opens it in Chromium, does what standard input says, and prints what was seen as JSON.

usage: visit.py CHROMIUM URL    (steps as a JSON list on standard input)

Nothing is downloaded: the browser is the one that is named.
"""

import json
import sys
import time

from playwright.sync_api import sync_playwright

TIMEOUT_MS = 60_000
# A software renderer on a busy machine draws few pictures per second.
QUIET_S = 2.0

# Names and sizes of everything that can be operated.
AUDIT = """() => {
  const shown = (e) => e.getClientRects().length > 0;
  const name = (e) => e.getAttribute('aria-label') || (e.labels && e.labels.length && e.labels[0].textContent.trim()) || e.textContent.trim();
  const controls = [...document.querySelectorAll('button, input, select, canvas, [role]')].filter(shown);
  const wide = [...document.querySelectorAll('body *')].filter((e) => shown(e) && !e.closest('.scroll, .canvas-box') && e.getBoundingClientRect().right > innerWidth + 1);
  return {
    controls: controls.length,
    unnamed: controls.filter((e) => !name(e) && e.getAttribute('role') !== 'status' && e.getAttribute('role') !== 'alert').map((e) => e.outerHTML.slice(0, 200)),
    width: innerWidth, scroll: document.documentElement.scrollWidth, wide: wide.map((e) => e.outerHTML.slice(0, 200)),
    lang: document.documentElement.lang, title: document.title, theme: getComputedStyle(document.body).backgroundColor,
    tables: [...document.querySelectorAll('table')].filter((t) => !t.getAttribute('aria-label')).length,
  };
}"""

SET = """([id, value, kind]) => {
  const input = document.getElementById(id);
  input.value = value;
  input.dispatchEvent(new Event(kind, { bubbles: true }));
}"""


def state(page):
    return page.evaluate("() => elbowroom.state()")


def wait_for(page, condition):
    page.wait_for_function(f"() => {{ const s = elbowroom.state(); return {condition}; }}", timeout=TIMEOUT_MS)
    return state(page)


def drag(page, step):
    """Drags a handle of a tool centre point by some pixels: the ball, or the axis 0, 1 or 2."""
    box = page.locator("#canvas").bounding_box()
    handles = page.evaluate("() => elbowroom.handles()")[step["robot"]]
    axis = step.get("axis")
    grip = handles["ball"] if axis is None else handles["tips"][axis]
    x, y = box["x"] + grip[0], box["y"] + grip[1]
    before = state(page)["number"]
    page.mouse.move(x, y)
    page.mouse.down()
    steps = 12
    for k in range(1, steps + 1):
        page.mouse.move(x + step["by"][0] * k / steps, y + step["by"][1] * k / steps)
    page.mouse.up()
    return settled(page, before)


def settled(page, number):
    """Every move of the pointer is a command; the last one has been answered when nothing comes any more."""
    quiet_since = time.monotonic()
    while time.monotonic() - quiet_since < QUIET_S:
        page.wait_for_timeout(50)
        now = state(page)["number"]
        if now != number:
            number, quiet_since = now, time.monotonic()
    return state(page)


def slide(page, step):
    """Drags a slider with the mouse to a share of its length."""
    box = page.locator(f"#{step['id']}").bounding_box()
    page.locator(f"#{step['id']}").scroll_into_view_if_needed()
    box = page.locator(f"#{step['id']}").bounding_box()
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + box["width"] / 2, y)
    page.mouse.down()
    for k in range(1, 9):
        page.mouse.move(box["x"] + box["width"] * (0.5 + (step["to"] - 0.5) * k / 8), y)
    page.mouse.up()
    return settled(page, None)


def perform(page, step):
    match step["do"]:
        case "state":
            return state(page)
        case "wait":
            return wait_for(page, step["until"])
        case "set":
            page.evaluate(SET, [step["id"], str(step["value"]), step.get("kind", "input")])
            return wait_for(page, step["until"]) if "until" in step else state(page)
        case "enter":
            # As a person types: the field keeps the focus.
            page.locator(step["at"]).fill(step["value"])
            page.keyboard.press("Enter")
            wait_for(page, step["until"])
            return page.locator(step["at"]).input_value()
        case "slide":
            return slide(page, step)
        case "drag":
            return drag(page, step)
        case "press":
            page.keyboard.press(step["key"])
            return wait_for(page, step["until"]) if "until" in step else state(page)
        case "click":
            # A control, or a place of the scene that shows a point of the world.
            if "at" in step:
                page.locator(step["at"]).click()
            else:
                box = page.locator("#canvas").bounding_box()
                x, y = page.evaluate("(point) => elbowroom.pixels(point)", step["world"])
                page.mouse.move(box["x"] + x, box["y"] + y)
                page.mouse.down()
                page.mouse.up()
            return wait_for(page, step["until"]) if "until" in step else state(page)
        case "choose":
            page.locator(step["at"]).select_option(step["value"])
            return state(page)
        case "fill":
            page.locator(step["at"]).fill(step["value"])
            page.keyboard.press("Tab")
            return state(page)
        case "type":
            page.locator(step["at"]).press_sequentially(step["value"])
            page.keyboard.press("Tab")
            return state(page)
        case "focus":
            page.locator(step["at"]).focus()
            return None
        case "tab":
            # What the tabulator reaches, in order.
            reached = []
            for _ in range(step["times"]):
                page.keyboard.press("Tab")
                reached.append(page.evaluate("() => document.activeElement.id || document.activeElement.tagName"))
            return reached
        case "sleep":
            page.wait_for_timeout(step["ms"])
            return state(page)
        case "audit":
            return page.evaluate(AUDIT)
        case "text":
            return page.locator(step["at"]).inner_text()
        case "screenshot":
            page.screenshot(path=step["file"], full_page=step.get("full", False))
            return None
    raise ValueError(f"no step is called {step['do']}")


def main():
    chromium, url = sys.argv[1:3]
    visit = json.load(sys.stdin)
    seen = {"problems": [], "steps": []}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium,
            headless=True,
            args=["--no-sandbox", "--enable-unsafe-swiftshader"],
        )
        seen["browser"] = browser.version
        context = browser.new_context(
            viewport={"width": visit.get("width", 1280), "height": visit.get("height", 800)},
            color_scheme=visit.get("scheme", "light"),
        )
        page = context.new_page()
        page.set_default_timeout(TIMEOUT_MS)
        page.on("console", lambda m: seen["problems"].append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda e: seen["problems"].append(str(e)))
        page.on("requestfailed", lambda r: seen["problems"].append(f"{r.url}: {r.failure}"))
        foreign = []
        page.on("request", lambda r: foreign.append(r.url) if not r.url.startswith((url.split("#")[0], "ws://", "data:")) else None)
        try:
            page.goto(url)
            if visit.get("ready", True):
                page.wait_for_function("() => document.documentElement.dataset.ready", timeout=TIMEOUT_MS)
            for step in visit["steps"]:
                seen["steps"].append(perform(page, step))
        except Exception:
            print("on the console:", seen["problems"], "on the page:", page.inner_text("body")[:300], file=sys.stderr)
            raise
        seen["foreign"] = foreign
        browser.close()
    # A refusal that the visit provokes is on the console too.
    seen["problems"] = [p for p in seen["problems"] if not any(text in p for text in visit.get("expected", []))]
    # Software rendering says so on the console.
    seen["problems"] = [p for p in seen["problems"] if "GPU stall due to ReadPixels" not in p and "GL Driver Message" not in p]
    json.dump(seen, sys.stdout)


if __name__ == "__main__":
    main()
