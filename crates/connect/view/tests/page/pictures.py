"""Pictures per second of a page that shows a moving cell, and where the time goes.

usage: pictures.py CHROMIUM URL [SECONDS]    (URL as `elbowroom view` or `elbowroom live … --web` prints it)

Opens the page in headless Chromium at 1280 × 720 without a graphics card. Linux: processor times are read from /proc.
"""

import collections
import os
import pathlib
import re
import sys
import time

from playwright.sync_api import sync_playwright

# The page has adapted to the speed of the computer by then.
SETTLED_S = 8.0
KEYS = ("pictures", "clock_s", "number", "pixel_ratio", "triangles")
TICK_S = 1.0 / os.sysconf("SC_CLK_TCK")


def state(page):
    return page.evaluate("(keys) => { const s = elbowroom.state(); return Object.fromEntries(keys.map((k) => [k, s[k]])); }", list(KEYS))


def parents():
    """The parent, the command and the processor time (s) of every process."""
    found = {}
    for folder in pathlib.Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
            command = (folder / "cmdline").read_text().replace("\0", " ")
        except OSError:
            continue  # it has ended
        found[int(folder.name)] = (int(fields[1]), command, TICK_S * (int(fields[11]) + int(fields[12])))
    return found


def processor_s():
    """Processor time of this program's browser, by the kind of process."""
    processes = parents()
    times = collections.Counter()
    for number, (_, command, seconds) in processes.items():
        above = number
        while above in processes and above != os.getpid():
            above = processes[above][0]
        kind = re.search(r"--type=(\S+)", command)
        if above == os.getpid() and kind:
            times[kind[1]] += seconds
    return times


def profile(page, seconds):
    """Shares of the time of the page's main thread, in per cent."""
    session = page.context.new_cdp_session(page)
    session.send("Profiler.enable")
    session.send("Profiler.setSamplingInterval", {"interval": 500})
    session.send("Profiler.start")
    page.wait_for_timeout(1000 * seconds)
    measured = session.send("Profiler.stop")["profile"]
    names = {"(idle)": "idle", "(program)": "browser, waiting for the picture", "(garbage collector)": "garbage"}
    what = {}
    for node in measured["nodes"]:
        call = node["callFrame"]
        what[node["id"]] = names.get(call["functionName"], call["url"].rsplit("/", 1)[-1] or "calls of the browser")
    times = collections.Counter()
    for sample, took in zip(measured["samples"], measured["timeDeltas"]):
        times[what[sample]] += took
    total = sum(times.values())
    return {name: 100.0 * took / total for name, took in times.most_common()}


def measure(page, seconds):
    page.wait_for_function("() => document.documentElement.dataset.ready", timeout=60_000)
    page.wait_for_timeout(1000 * SETTLED_S)
    begin, before = state(page), processor_s()
    time.sleep(seconds)
    end, after = state(page), processor_s()
    pictures, passed = end["pictures"] - begin["pictures"], end["clock_s"] - begin["clock_s"]
    print(f"{pictures / passed:.1f} pictures per second of {(end['number'] - begin['number']) / passed:.1f} statuses")
    print(f"pixels of 1/{end['pixel_ratio']:.2g}, {end['triangles']} triangles")
    for kind, used in (after - before).most_common():
        print(f"{1000 * used / max(pictures, 1):5.1f} ms of processor time per picture: {kind}")
    for name, share in profile(page, seconds).items():
        print(f"{share:5.1f} % of the main thread: {name}")


def main():
    chromium, url = sys.argv[1:3]
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 15.0
    with sync_playwright() as playwright:
        flags = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=chromium, headless=True, args=flags)
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        page.goto(url)
        measure(page, seconds)
        browser.close()


if __name__ == "__main__":
    main()
